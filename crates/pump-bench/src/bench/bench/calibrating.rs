//! The calibrations of a bench: used, kept, and made from the weight of the last dose.

use libm::sqrt;

use crate::bench::Bench;
use crate::calibration::{
    Calibration, CalibrationError, Earlier, Expected, LastWeighing, Stored, WeighedDose,
};
use crate::dosing::{DoseError, drop_ml};
use crate::pump_file::PumpFile;
use crate::record::{DosedFluid, LastDose, LogEntry, LogError, LogLine, Purpose, Stamp};
use crate::units::StatedReading;

impl Bench {
    /// Makes doses use a calibration from now on, or none.
    ///
    /// # Errors
    ///
    /// [`DoseError`] while a dose is unfinished, because its rest would change, or if the calibration cannot
    /// be used.
    pub fn use_calibration(&self, version: Option<u32>) -> Result<(), DoseError> {
        self.refuse_unfinished(self.story()?.state)?;
        Ok(self.calibrations().activate(version)?)
    }

    /// Keeps a calibration, as one of the tube in the head, and makes doses use it from now on. The caller must hold
    /// the pump's lock.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::use_calibration`], or if the calibration cannot be written.
    pub fn keep_calibration(&self, calibration: Calibration) -> Result<Stored, DoseError> {
        let stored = self.add_calibration(calibration)?;
        self.use_calibration(Some(stored.version))?;
        Ok(stored)
    }

    /// Returns the number of the tube in the head.
    fn tube(&self) -> Result<u32, DoseError> {
        Ok(self.story()?.state.map_or(1, |state| state.tube()))
    }

    /// Keeps a calibration under the next number, as one of the tube in the head.
    fn add_calibration(&self, calibration: Calibration) -> Result<Stored, DoseError> {
        self.refuse_unfinished(self.story()?.state)?;
        let calibration = Calibration { tube_number: Some(self.tube()?), ..calibration };
        let version = self.calibrations().add(&calibration)?;
        Ok(Stored { version, calibration })
    }

    /// Keeps the calibration that the weight of the last dose gave. Doses use it from now on, unless it is less sure
    /// than the model ([`Self::would_use`]). Then it waits: the next weighed dose joins it. The caller must hold the
    /// pump's lock.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::keep_calibration`].
    pub fn keep_weighing(&self, calibration: Calibration) -> Result<Stored, DoseError> {
        if self.would_use(&calibration)? {
            return self.keep_calibration(calibration);
        }
        // The pointer goes first: a weighing that is kept after it waits, whatever happens in between.
        self.refuse_unfinished(self.story()?.state)?;
        self.calibrations().wait()?;
        self.add_calibration(calibration)
    }

    /// Returns false for weighed doses that show the mean volume less well than the model, while no calibration is in
    /// use.
    ///
    /// # Errors
    ///
    /// [`DoseError::Calibration`] if the calibrations cannot be read, or the displacement cannot be had of this pump.
    pub fn would_use(&self, calibration: &Calibration) -> Result<bool, DoseError> {
        if self.calibrations().active_version()?.is_some() {
            return Ok(true);
        }
        Ok(!calibration.is_less_sure_than_the_model(self.file(), self.model())?)
    }

    /// Returns the calibration that the weight of the last dose gives. [`Self::keep_weighing`] keeps it.
    ///
    /// `file` is that of [`Self::file_of_last_dose`].
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] where the record cannot be read. [`DoseError::Calibration`] with the errors of
    /// [`CalibrationRun::of_last_dose`], [`CalibrationRun::beside`] and [`Calibration::of_runs`].
    ///
    /// [`CalibrationRun::of_last_dose`]: crate::calibration::CalibrationRun::of_last_dose
    /// [`CalibrationRun::beside`]: crate::calibration::CalibrationRun::beside
    pub fn weigh_last_dose(
        &self,
        file: &PumpFile,
        reading: &StatedReading,
        earlier: Earlier,
        expected: &Expected,
    ) -> Result<WeighedDose, DoseError> {
        let calibrations = self.calibrations();
        let in_use = calibrations.active()?;
        let active = match in_use.clone() {
            None => calibrations.waiting(self.tube()?)?,
            active => active,
        };
        let last = self.last_dose()?;
        let expected = self.with_drop(expected)?;
        let weighing = LastWeighing { reading, earlier, in_use: in_use.as_ref(), expected: &expected };
        Ok(WeighedDose::of(file, last, active.as_ref(), &weighing)?)
    }

    /// Returns the last dose, if there is one to weigh.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] where the record cannot be read.
    pub fn last_dose(&self) -> Result<Option<LastDose>, DoseError> {
        Ok(self.story()?.state.and_then(|state| state.last))
    }

    /// Checks that the dose that was weighed is still the last one. `dose` is its number in the log, or the order of a
    /// service that made it or its rest. The caller holds the pump's lock, so that no dose comes after the check.
    ///
    /// # Errors
    ///
    /// [`CalibrationError::DosedSince`] if another dose came since, [`CalibrationError::NoSuchDose`] if there was none
    /// of this name, and [`DoseError`] where the record cannot be read.
    pub fn check_is_last_dose(&self, dose: &str) -> Result<(), DoseError> {
        let is_named = |entry: &LogEntry| {
            entry.number.to_string() == dose || entry.order.is_some_and(|order| order.as_str() == dose)
        };
        let (mut last, mut is_known) = (None, false);
        let unread = |error: LogError| {
            let LogError { action, path, source } = error;
            CalibrationError::File { action, path, source }
        };
        for line in self.log().map_err(unread)? {
            let LogLine::Dose(entry) = line.map_err(unread)? else { continue };
            // A retraction after the dose moves nothing into the vessel.
            if entry.purpose != Purpose::Retract {
                is_known |= is_named(&entry);
                last = Some(entry);
            }
        }
        let since = self.story()?.state.and_then(|state| state.unfinished).map(|dose| dose.intent);
        // A dose that was stopped is in the log, and stays unfinished.
        let since = since.filter(|intent| last.as_ref().is_none_or(|last| last.time.unix_s != intent.unix_s));
        let since = since.and_then(|intent| {
            intent
                .told
                .map(|told| (told.asked, intent.requested_ml, Stamp::new(intent.unix_s, told.utc_offset_s)))
        });
        let of_log =
            last.filter(|entry| !is_named(entry)).map(|entry| (entry.asked, entry.requested_ml, entry.time));
        match since.or(of_log) {
            _ if !is_known => Err(CalibrationError::NoSuchDose { dose: dose.to_owned() }.into()),
            None => Ok(()),
            Some((asked, requested_ml, time)) => {
                let volume =
                    asked.map_or_else(|| format!("{requested_ml:.4} mL"), |asked| asked.as_str().to_owned());
                Err(CalibrationError::DosedSince { volume, time: time.to_string() }.into())
            }
        }
    }

    /// Returns the number of the last dose in the log, 0 before the first.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] where the record cannot be read.
    pub fn last_number(&self) -> Result<u64, DoseError> {
        Ok(self.story()?.state.map_or(0, |state| state.doses))
    }

    /// Returns the pump file with the fluid of the last dose, as it is on record. A name and a temperature, in °C, that
    /// a person states win. A dose of an early version, whose fluid is not on record, was of the pump file's.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] where the record cannot be read. [`DoseError::Calibration`] with
    /// [`CalibrationError::DosedWith`] for a fluid on record of which nothing is known by now, and
    /// [`CalibrationError::Fluid`] for one that a person states.
    pub fn file_of_last_dose(
        &self,
        name: Option<&str>,
        temperature_degc: Option<f64>,
    ) -> Result<PumpFile, DoseError> {
        let own = &self.file().fluid;
        let dosed = self.last_dose()?.and_then(|dose| dose.fluid).unwrap_or(DosedFluid::of(own));
        let is_stated = name.is_some() || temperature_degc.is_some();
        let fluid = dosed.table(own, name, temperature_degc).map_err(|source| match is_stated {
            true => CalibrationError::Fluid(source),
            false => CalibrationError::DosedWith { dosed: dosed.to_string(), source },
        })?;
        Ok(PumpFile { fluid, ..self.file().clone() })
    }

    /// Returns what is expected of a weighed dose or run with the drop at the nozzle: a dose has the same share.
    ///
    /// # Errors
    ///
    /// [`DoseError::Calibration`] if the drop cannot be computed.
    pub fn with_drop(&self, expected: &Expected) -> Result<Expected, DoseError> {
        let drop_ml = drop_ml(self.file()).map_err(CalibrationError::Model)?;
        Ok(expected.with_drop_ml(drop_ml / sqrt(6.0)))
    }
}
