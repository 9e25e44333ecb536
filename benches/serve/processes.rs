//! Processor time and memory of processes, from Linux's /proc.

use std::error::Error;
use std::fs;

/// Ticks of the processor's time in a second, which Linux has fixed for programs.
const TICKS: f64 = 100.0;

/// A process, and those that it started.
pub(crate) struct Family(Vec<u32>);

impl Family {
    /// A process, and those that it has now.
    pub(crate) fn of(process: u32) -> Self {
        let tasks = fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
        let children = tasks.filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
        let children: Vec<u32> = children
            .flat_map(|text| text.split_whitespace().filter_map(|word| word.parse().ok()).collect::<Vec<_>>())
            .collect();
        Self([vec![process], children].concat())
    }

    /// One process without those that it started.
    pub(crate) fn alone(process: u32) -> Self {
        Self(vec![process])
    }

    /// Number of processes.
    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Returns the processor time until now, in s.
    pub(crate) fn processor_s(&self) -> Result<f64, Box<dyn Error>> {
        self.0.iter().map(|process| processor_s(*process)).sum()
    }

    /// Returns the memory in MB: what several processes share counts once.
    pub(crate) fn memory_mb(&self) -> Result<f64, Box<dyn Error>> {
        self.0.iter().map(|process| memory_mb(*process)).sum()
    }
}

fn processor_s(process: u32) -> Result<f64, Box<dyn Error>> {
    let text = fs::read_to_string(format!("/proc/{process}/stat"))?;
    // The name in parentheses may have spaces.
    let fields = text.rsplit_once(')').ok_or("no name in stat")?.1.split_whitespace();
    let ticks: Vec<f64> = fields.skip(11).take(2).map(str::parse).collect::<Result<_, _>>()?;
    Ok(ticks.iter().sum::<f64>() / TICKS)
}

fn memory_mb(process: u32) -> Result<f64, Box<dyn Error>> {
    let text = fs::read_to_string(format!("/proc/{process}/smaps_rollup"))?;
    let line = text.lines().find_map(|line| line.strip_prefix("Pss:")).ok_or("no Pss in smaps_rollup")?;
    let kib: f64 = line.trim().trim_end_matches(" kB").parse()?;
    Ok(kib * 1024.0 / 1e6)
}
