//! A sizing in words for people.

use crate::notice::Wording;
use crate::numbers::significant;
use crate::sizing::{PressureSource, SizedLine, Sizing};

/// Smallest friction that is said, in kPa.
const LEAST_KPA: f64 = 0.001;

/// Returns the title of a sizing: flow, fluid, pump and speed.
pub fn sizing_title(sizing: &Sizing) -> String {
    format!(
        "{} mL/min of {} at {} °C: {} at {} r/min",
        significant(60.0 * sizing.flow_ml_s, 4),
        sizing.fluid.name,
        sizing.fluid.temperature_degc,
        sizing.head.name,
        significant(sizing.speed_rpm, 4)
    )
}

/// Returns a sizing as lines for people. A front end words the remedies.
pub fn sizing_text(sizing: &Sizing, words: Wording) -> String {
    let rows = [
        ("head", head(sizing)),
        ("speed", speed(sizing)),
        ("fluid", fluid(sizing)),
        ("inlet", line(&sizing.inlet, "lift from the supply")),
        ("outlet", line(&sizing.outlet, "lift to the vessel")),
        ("pressures", pressures(sizing)),
        ("suction", suction(sizing)),
        ("discharge", discharge(sizing)),
        ("pulsation", pulsation(sizing)),
        (
            "settling",
            format!(
                "{} s after an abrupt stop, until 1 µL is still to come",
                significant(sizing.settle_s, 3)
            ),
        ),
        ("also", sizing.others.join(", ")),
        ("not known", sizing.unknown.join("; ")),
    ];
    let mut text = format!("{}\n\n", sizing_title(sizing));
    for (name, said) in rows.iter().filter(|(_, said)| !said.is_empty()) {
        text.push_str(&format!("  {name:<11}{said}\n"));
    }
    for warning in &sizing.warnings {
        text.push_str(&format!("  warning    {}\n", warning.worded(words)));
    }
    text
}

fn head(sizing: &Sizing) -> String {
    let head = &sizing.head;
    let is_named = head.catalogued.as_ref().is_some_and(|row| row.head.contains("rollers"));
    let rollers = if is_named { String::new() } else { format!(", {} rollers", head.rollers) };
    let volume = format!("{} mL per revolution{rollers}", significant(head.ml_per_rev, 4));
    match &head.catalogued {
        Some(row) => format!(
            "{} {}, {}: {volume} (published: {}; {})",
            row.maker, row.head, row.tubing, row.published, row.source.kind
        ),
        None => volume,
    }
}

fn speed(sizing: &Sizing) -> String {
    let head = &sizing.head;
    let stated = match (head.least_rpm, head.most_rpm) {
        (_, None) => "no largest speed is stated".to_owned(),
        (least, Some(most)) => format!("stated {} to {most}", least.unwrap_or(0.0)),
    };
    let since = match head.catalogued {
        Some(_) => "until somebody weighs it",
        None => "by the pump file; its calibrations are not counted here",
    };
    format!(
        "{} r/min ({stated}); the flow is within {} % (k = 2) {since}",
        significant(sizing.speed_rpm, 4),
        significant(100.0 * sizing.expanded, 2)
    )
}

fn fluid(sizing: &Sizing) -> String {
    let fluid = &sizing.fluid;
    let viscosity = sizing
        .viscosity_mpa_s
        .map_or("unknown viscosity".to_owned(), |mpa_s| format!("{} mPa s", significant(mpa_s, 3)));
    let is_mixture = fluid.vapour_kpa.is_none() && fluid.name.starts_with("glycerol");
    let by = if is_mixture { " at most (Raoult's law)" } else { "" };
    let vapour = match sizing.suction.vapour_kpa {
        Some(kpa) => format!("boils at {} kPa absolute{by}", significant(kpa, 3)),
        None => "vapour pressure unknown".to_owned(),
    };
    format!("{} kg/m³, {viscosity}, {vapour}", significant(fluid.density_kg_m3, 5))
}

fn line(line: &SizedLine, lifted: &str) -> String {
    let hose = match line.hose {
        Some(hose) => format!(
            "{} x {} mm, {} m: ",
            significant(2.0 * hose.bore_radius_mm, 4),
            significant(2.0 * hose.outer_radius_mm, 4),
            significant(1e-3 * hose.length_mm, 4)
        ),
        None => "R, C and L of the pump file: ".to_owned(),
    };
    let law = line.reynolds.zip(line.law).map_or(String::new(), |(reynolds, law)| {
        format!("Re {}, {}, ", significant(reynolds, 3), law.told())
    });
    let lift = match line.lift_mm {
        Some(mm) => {
            format!("{lifted} {} m, {} kPa", significant(1e-3 * mm, 4), significant(line.lift_kpa, 4))
        }
        None => format!("reservoir at {} kPa absolute", significant(line.line.reservoir_kpa, 5)),
    };
    let friction = match line.friction_kpa {
        kpa if kpa < LEAST_KPA => format!("below {LEAST_KPA}"),
        kpa => significant(kpa, 3),
    };
    format!("{hose}{law}friction {friction} kPa; {lift}")
}

fn pressures(sizing: &Sizing) -> String {
    let steady = &sizing.steady;
    format!(
        "inlet {:.2} to {:.2}, mean {:.2}; outlet {:.2} to {:.2}, mean {:.2} kPa absolute (air {:.2})",
        steady.inlet_min_kpa,
        steady.inlet_max_kpa,
        steady.inlet_mean_kpa,
        steady.outlet_min_kpa,
        steady.outlet_max_kpa,
        steady.outlet_mean_kpa,
        sizing.ambient_kpa
    )
}

fn suction(sizing: &Sizing) -> String {
    let suction = &sizing.suction;
    let npsh = suction.npsh_m.map(|metres| {
        format!("NPSH available {} m of the fluid at the lowest inlet pressure", significant(metres, 3))
    });
    let margin = suction
        .margin_kpa
        .zip(suction.limit_kpa)
        .map(|(margin, limit)| format!("margin {margin:.2} kPa above the limit of {limit:.2} kPa absolute"));
    let collapse = match suction.collapse_kpa {
        Some(kpa) => format!("the tube collapses at {kpa:.2} kPa (thin-wall estimate)"),
        None => "the tube's collapse is not known".to_owned(),
    };
    npsh.into_iter().chain(margin).chain([collapse]).collect::<Vec<_>>().join("; ")
}

fn discharge(sizing: &Sizing) -> String {
    let most_kpa = sizing.steady.outlet_max_kpa - sizing.ambient_kpa;
    match sizing.largest {
        None => format!("{most_kpa:.2} kPa above the air at most; no limit is known"),
        Some(limit) => {
            let source = match limit.source {
                PressureSource::Given => "as given",
                PressureSource::Tubing => "suggested for tubing of this wall and bore",
            };
            format!(
                "{most_kpa:.2} kPa above the air at most, of {:.0} allowed ({source})",
                limit.kpa - sizing.ambient_kpa
            )
        }
    }
}

fn pulsation(sizing: &Sizing) -> String {
    let pulsation = &sizing.pulsation;
    let percent = |part: f64| significant(100.0 * part, 3);
    let between = pulsation.end_between.map_or(String::new(), |[least, most]| {
        format!(" ({} to {} % peak to peak for 95 % of such heads)", percent(least), percent(most))
    });
    let end = match pulsation.end {
        Some(ripple) => format!(
            "{} % peak to peak, {} % RMS at the hose's end{between}; ",
            percent(ripple.peak_to_peak),
            percent(ripple.rms)
        ),
        None => "the line resonates, and nothing damps it; ".to_owned(),
    };
    format!("{end}{} % peak to peak at the rollers", percent(pulsation.rollers.peak_to_peak))
}
