//! `dose pumps new --head` and `--ml-per-rev`: a pump file of a bought head, from the catalogue or by its volume alone.

use pump_bench::catalogue::{BoughtPump, CataloguedPump};
use pump_bench::heads::{BoughtHead, bought_head, nearest_heads};
use pump_bench::pump_file::{HeadTable, PumpFile};
use pump_bench::report::ErrorKind;
use pump_bench::setup::SetupError;

use super::new::{NewArgs, write_new};
use crate::advice;
use crate::failure::Failure;
use crate::terminal::{print, tell};

impl NewArgs {
    /// Writes the file of a pump with a bought head.
    pub(super) fn write_bought(&self) -> Result<(), Failure> {
        if let Some(name) = &self.head {
            return self.write_catalogued(name);
        }
        let (Some(ml_per_rev), Some(rollers)) = (self.ml_per_rev, self.rollers) else {
            return Err(Failure::refused(
                "a new pump needs --head NAME, --ml-per-rev VOLUME with --rollers N, or the dimensions of its drawing",
            ));
        };
        let mut head = HeadTable::new(ml_per_rev);
        head.tube_bore_mm = self.bore;
        let pump = BoughtPump { id: self.id(), head, rollers };
        let mut file = pump.pump_file();
        let motor = self.state(&mut file)?;
        let text = pump.toml_of(&file, advice::words);
        PumpFile::parse(&text, "from this volume").map_err(Failure::of)?;
        self.put_bought(&file, &text, &motor)
    }

    /// Writes the file of a pump with a head of the catalogue.
    fn write_catalogued(&self, name: &str) -> Result<(), Failure> {
        let head = catalogued(name)?;
        if let (Some(published), Some(rollers)) = (head.rollers, self.rollers)
            && published != rollers
        {
            return Err(SetupError::Rollers { head: head.name.clone(), published, rollers }.into());
        }
        let Some(rollers) = self.rollers.or(head.rollers) else {
            let refused = Failure::refused(format!(
                "the document of {name} does not state the number of rollers; count yours and add --rollers 3"
            ));
            return Err(refused.kind(ErrorKind::Usage).value("no --rollers").allowed("--rollers N"));
        };
        let pump = CataloguedPump::new(self.id(), head, rollers);
        let mut file = pump.pump_file().map_err(Failure::of)?;
        let motor = self.state(&mut file)?;
        let text = pump.toml_of(&file, advice::words);
        // The file must be readable again, its id too.
        PumpFile::parse(&text, "from the catalogue").map_err(Failure::of)?;
        self.put_bought(&file, &text, &motor)
    }

    /// Puts the text where it is to go, with the words on the motor, and warns of what is unusual.
    fn put_bought(&self, file: &PumpFile, text: &str, motor: &str) -> Result<(), Failure> {
        match &self.file {
            None => print(text)?,
            Some(path) => {
                write_new(path, text)?;
                tell(&format!("  {motor}\n"))?;
            }
        }
        self.warn(file)
    }
}

/// The head of the catalogue, or a refusal with the nearest names.
fn catalogued(name: &str) -> Result<&'static BoughtHead, Failure> {
    bought_head(name).ok_or_else(|| {
        let nearest = nearest_heads(name).join(", ");
        let refused = Failure::refused(format!(
            "no head of the catalogue is `{name}`; the nearest are {nearest}; `dose pumps list --catalogue` has all, \
             and any other head is known by --ml-per-rev"
        ));
        refused.kind(ErrorKind::Usage).value(name).allowed(&nearest)
    })
}
