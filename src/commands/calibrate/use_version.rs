//! `dose calibrate use`: doses use another calibration, or none.

use clap::Args;

use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::terminal::tell;

#[derive(Debug, Args)]
pub(super) struct UseArgs {
    /// Number of the calibration, or none
    #[arg(value_name = "N|none")]
    version: String,
    #[command(flatten)]
    record: RecordOptions,
}

impl UseArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let bench = self.record.bench()?;
        let wanted = match self.version.as_str() {
            "none" => None,
            number => Some(number.parse().map_err(|_| {
                Failure::refused(format!(
                    "`{number}` is no calibration; write its number from `dose calibrate list`, or none"
                ))
                .value(number)
            })?),
        };
        let _held = bench.folder().lock()?;
        bench.use_calibration(wanted)?;
        tell(&wanted.map_or("doses use no calibration from now on\n".to_owned(), |version: u32| {
            format!("doses use calibration {version} from now on\n")
        }))
    }
}
