//! `dose status`: what is on record.

use pump_bench::report::Status;

use crate::failure::{Failure, print};
use crate::options::Options;

pub(crate) fn status(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose status", &["--driver", "--port", "--format", "--tube-limit"])?;
    let status = Status::of(&options.bench()?)?;
    print(&if options.json() { status.json() + "\n" } else { status.text() })
}
