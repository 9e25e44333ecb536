//! The files that a command writes: all of them or none.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use pump_bench::export::{Marks, PlotError, waveform_svg, write_samples};
use pump_bench::files::Staged;
use pump_bench::report::{ErrorKind, Explain};
use pump_bench::simulation::Sample;

use crate::failure::Failure;
use crate::interrupt;

/// Time between rows of a trace unless told otherwise, s.
pub(crate) const DEFAULT_DT_S: f64 = 1e-3;

/// Most samples that a picture is drawn from; they are kept in memory.
pub(crate) const PLOT_SAMPLES: f64 = 1e6;

/// Files that are written and wait to be put in place together.
#[derive(Default)]
pub(crate) struct Outputs {
    staged: Vec<(PathBuf, Staged)>,
}

impl Outputs {
    /// Writes a file beside its place.
    pub(crate) fn write(
        &mut self,
        path: &Path,
        contents: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        // No output is a TOML file, but pumps, racks, schedules and the configuration are.
        if path.extension().is_some_and(|extension| extension == "toml") && path.exists() {
            let refused = Failure::refused(format!(
                "{}: there is a TOML file, and it would be lost; name another file",
                path.display()
            ));
            return Err(refused
                .kind(ErrorKind::Output)
                .value(path.display())
                .allowed("a file that is not there"));
        }
        let staged =
            Staged::new(path, |to| contents(&mut Watched(to))).map_err(|error| unwritten(path, &error))?;
        self.staged.push((path.to_owned(), staged));
        Ok(())
    }

    /// Writes a waveform as CSV.
    pub(crate) fn trace<E: std::error::Error + Send + Sync + 'static>(
        &mut self,
        path: &Path,
        samples: impl Iterator<Item = Result<Sample, E>>,
    ) -> Result<(), Failure> {
        self.write(path, |to| write_samples(to, samples.map(|sample| sample.map_err(io::Error::other))))
    }

    /// Draws a waveform with its marks.
    pub(crate) fn plot<E: Explain>(
        &mut self,
        path: &Path,
        title: &str,
        samples: impl Iterator<Item = Result<Sample, E>>,
        marks: &Marks,
    ) -> Result<(), Failure> {
        let samples = samples.collect::<Result<Vec<_>, _>>().map_err(Failure::of)?;
        self.drawing(path, waveform_svg(title, &samples, marks))
    }

    /// Writes a drawing.
    pub(crate) fn drawing(&mut self, path: &Path, svg: Result<String, PlotError>) -> Result<(), Failure> {
        if path.extension().is_some_and(|extension| !extension.eq_ignore_ascii_case("svg")) {
            let path = path.display();
            let refused = Failure::refused(format!("{path}: plots are SVG; name a file that ends in .svg"));
            return Err(refused.kind(ErrorKind::Output).value(path).allowed("a file that ends in .svg"));
        }
        let svg = svg.map_err(Failure::of)?;
        self.write(path, |to| to.write_all(svg.as_bytes()))
    }

    /// Puts every file in place.
    pub(crate) fn put(self) -> Result<(), Failure> {
        for (path, staged) in self.staged {
            staged.put().map_err(|error| Failure::unwritten(&path, &error))?;
        }
        Ok(())
    }
}

/// A writer that refuses to go on once a signal came.
struct Watched<'a>(&'a mut dyn Write);

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if interrupt::signal().is_some() {
            return Err(io::Error::other("stopped by the user"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Returns the failure of an output that was not written.
fn unwritten(path: &Path, error: &io::Error) -> Failure {
    if let Some(signal) = interrupt::signal() {
        let message = format!("stopped by the user while {} was written; nothing moved", path.display());
        return Failure::stopped(signal, false, message);
    }
    Failure::unwritten(path, error)
}
