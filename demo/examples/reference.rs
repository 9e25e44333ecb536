//! The figures that this machine computes for some doses, bit by bit, as JSON. `check.mjs` holds the page's module to
//! them.

use std::fmt::Write;

use pump_demo::Demo;
use pump_model::{Line, units::degrees};

/// Time between the rows of the waveforms, s.
const DT_S: f64 = 0.001;

/// Adds numbers as their bits.
fn add_bits(to: &mut String, numbers: &[f64]) {
    let bits: Vec<String> = numbers.iter().map(|number| format!("\"{:016x}\"", number.to_bits())).collect();
    let _ = write!(to, "[{}]", bits.join(","));
}

fn main() {
    let Line { resistance_kpa_s_ml: r, compliance_ml_kpa: c, inertance_kpa_s2_ml: l, .. } = Line::PUBLISHED;
    // README's doses begin at 0.3 rad.
    let readme_deg = degrees(0.3);
    let cases = [
        ("README's dose", [3.0, 3.0, 1.0, 25.0, readme_deg, 5.0, 0.0, r, c, l]),
        ("README's dose at 10 mL/s", [3.0, 3.0, 1.0, 25.0, readme_deg, 10.0, 0.0, r, c, l]),
        ("smooth", [3.0, 3.0, 1.0, 25.0, 17.19, 5.0, 1.0, r, c, l]),
        ("small", [3.0, 3.0, 1.0, 1.0, 61.5, 2.0, 0.0, r, c, l]),
        ("two rollers", [2.0, 2.0, 1.0, 12.5, 100.0, 4.0, 1.0, r, c, l]),
        ("another line", [3.0, 3.0, 1.0, 10.0, 0.0, 3.0, 0.0, 0.3, 0.02, 0.001]),
        ("another head", [0.0, 24.0, 1.5, 2.0, 7.0, 1.0, 1.0, r, c, l]),
        ("another smooth head", [0.0, 6.0, 6.3, 25.0, 17.19, 5.0, 1.0, r, c, l]),
        ("too many rollers", [0.0, 25.0, 1.5, 2.0, 7.0, 1.0, 0.0, r, c, l]),
        ("too fast", [3.0, 3.0, 1.0, 25.0, 0.0, 90.0, 0.0, r, c, l]),
        ("no volume", [3.0, 3.0, 1.0, f64::NAN, 0.0, 5.0, 0.0, r, c, l]),
    ];
    let mut text = String::from("[");
    // It is larger than the stack of a thread.
    let mut demo = Box::new(Demo::new());
    for (n, (name, settings)) in cases.into_iter().enumerate() {
        *demo.settings_mut() = settings;
        let is_planned = demo.plan();
        let _ = write!(text, "{}\n{{\"name\":\"{name}\",\"settings\":", if n > 0 { "," } else { "" });
        add_bits(&mut text, &settings);
        if is_planned {
            text.push_str(",\"facts\":");
            add_bits(&mut text, demo.facts());
            let mut times = Vec::new();
            loop {
                let count = demo.steps(times.len() as u64);
                if count == 0 {
                    break;
                }
                times.extend_from_slice(&demo.step_times()[..count]);
            }
            if demo.cautions() {
                text.push_str(",\"cautions\":");
                add_bits(&mut text, demo.caution_figures());
            }
            text.push_str(",\"steps\":");
            add_bits(&mut text, &times);
            let rows = demo.trace(DT_S);
            let columns: Vec<f64> =
                demo.columns().iter().flat_map(|column| &column[..rows]).copied().collect();
            let _ = write!(text, ",\"dt\":{DT_S},\"trace\":");
            add_bits(&mut text, &columns);
            let angles = demo.errors();
            let errors: Vec<f64> =
                demo.error_columns().iter().flat_map(|column| &column[..angles]).copied().collect();
            text.push_str(",\"errors\":");
            add_bits(&mut text, &errors);
        } else {
            let refusal = String::from_utf8_lossy(demo.refusal());
            let _ = write!(text, ",\"refusal\":\"{refusal}\"");
        }
        text.push('}');
    }
    println!("{text}\n]");
}
