//! Balances that a Python program reads, or that end a dose.

use std::fmt::{self, Debug, Formatter};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use pump_bench::balance::{
    Balance as DoseBalance, BalanceError, BalanceReading, ProgramBalance, Protocol, SerialBalance,
    SerialLine, agreeing, printed_reading,
};
use pump_bench::drives::StopRequest;
use pump_bench::units;
use pyo3::prelude::*;

use crate::argument::{quantity, word};
use crate::python::errors::{self, PumpError, value};

/// Longest wait for a balance that can be asked for, s: a day.
const MOST_WAIT_S: f64 = 86_400.0;

/// Device of a balance, which one dose or one reading uses at a time.
pub(super) type Device = Arc<Mutex<Option<Box<dyn DoseBalance>>>>;

/// Balance under the vessel: at a serial port, read by a program, or read by a function.
///
/// It ends doses (`Bench.dose` with `until_scale`), and `read` gives a reading for `Bench.calibrate_last`,
/// `Bench.verify` or `WeighedRun.weighed`. One dose or reading uses it at a time.
#[pyclass(frozen, module = "pumpmodel")]
pub(crate) struct Balance {
    device: Device,
    pub(super) wait: Duration,
    name: String,
}

#[pymethods]
impl Balance {
    /// Open the balance at a serial port. Nothing is asked yet.
    ///
    /// Parameters
    /// ----------
    /// port : str or os.PathLike
    ///     Serial port of the balance, as "/dev/ttyUSB1".
    /// protocol : {"mt-sics", "sbi"}
    ///     Protocol: MT-SICS of Mettler-Toledo and many others, or SBI of Sartorius.
    /// line : str, optional
    ///     Speed, 300 to 921600 baud, and framing of the line, as "9600,8N1". By default 9600,8N1, and
    ///     9600,7O1 for "sbi".
    /// wait : str, optional
    ///     Longest wait for the balance to stand still, up to a day; by default "60s".
    ///
    /// Raises
    /// ------
    /// BalanceError
    ///     If the port cannot be opened, or another process has it.
    /// ValueError
    ///     If the value of a keyword is not allowed.
    #[staticmethod]
    #[pyo3(signature = (port, *, protocol = "mt-sics", line = None, wait = None))]
    fn open(
        port: PathBuf,
        protocol: &str,
        line: Option<&str>,
        wait: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let protocol = word("protocol", protocol, Protocol::ALL)?;
        let line = match line {
            Some(line) => line.parse::<SerialLine>().map_err(|error| value(format_args!("line: {error}")))?,
            None => protocol.usual_line(),
        };
        let wait = wait_of(wait)?;
        let device = SerialBalance::open(&port, line, protocol).map_err(|error| errors::balance(&error))?;
        Ok(Self::of(device, wait, format!("at {}, {protocol} {line}", port.display())))
    }

    /// Read the balance by a command of the system's shell.
    ///
    /// Parameters
    /// ----------
    /// command : str
    ///     Command that prints at once what the balance shows, with its unit: kg, g or mg, as "23.45 g". The
    ///     last line counts.
    /// wait : str, optional
    ///     Longest wait for the command, up to a day; by default "60s".
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the command is empty, or `wait` no time.
    #[staticmethod]
    #[pyo3(signature = (command, *, wait = None))]
    fn command(command: String, wait: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        if command.trim().is_empty() {
            return Err(value("command is empty; give one that prints what the balance shows, as 23.45 g"));
        }
        let name = format!("by `{command}`");
        Ok(Self::of(ProgramBalance::new(command), wait_of(wait)?, name))
    }

    /// Read the balance by a function.
    ///
    /// Parameters
    /// ----------
    /// read : callable
    ///     Function that returns at once what the balance shows, with its unit: kg, g or mg, as "23.45 g". A
    ///     thread of the bench calls it up to 20 times a second during a dose.
    /// wait : str, optional
    ///     Longest wait for two readings that agree, up to a day; by default "60s".
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `read` cannot be called, or `wait` is no time.
    #[staticmethod]
    #[pyo3(signature = (read, *, wait = None))]
    fn function(read: &Bound<'_, PyAny>, wait: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        if !read.is_callable() {
            return Err(value(
                "read is no function; give one that returns what the balance shows, as \"23.45 g\"",
            ));
        }
        let name = format!("by {}", read.repr()?);
        let device = FunctionBalance { read: read.clone().unbind(), name: read.repr()?.to_string() };
        Ok(Self::of(device, wait_of(wait)?, name))
    }

    /// Read what the balance shows once it stands still.
    ///
    /// Returns
    /// -------
    /// str
    ///     Mass with its unit and the digits of the balance, as "23.45 g"; negative below its tare.
    ///
    /// Raises
    /// ------
    /// BalanceError
    ///     If the balance does not stand still in time, tells no mass, or is overloaded.
    fn read(&self, py: Python<'_>) -> PyResult<String> {
        let device = self.device()?;
        let wait = self.wait;
        let raised: Arc<Mutex<Option<PyErr>>> = Arc::default();
        let heard = Arc::clone(&raised);
        let stop = StopRequest::new(move || {
            let mut raised = heard.lock().unwrap_or_else(PoisonError::into_inner);
            if raised.is_none() {
                *raised = Python::attach(|py| py.check_signals()).err();
            }
            raised.is_some()
        });
        let read = py.detach(move || {
            let mut held = match device.try_lock() {
                Ok(held) => held,
                Err(TryLockError::Poisoned(held)) => held.into_inner(),
                Err(TryLockError::WouldBlock) => return None,
            };
            Some(held.as_mut().map(|balance| balance.read_still(wait, &stop)))
        });
        if let Some(error) = raised.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return Err(error);
        }
        match read {
            Some(Some(read)) => read.map(|reading| reading.shown()).map_err(|error| errors::balance(&error)),
            Some(None) => Err(closed()),
            None => Err(PumpError::new_err("a dose or another thread reads this balance; wait for it")),
        }
    }

    /// Close the balance, after the dose that it ends. Closing twice is no error.
    fn close(&self, py: Python<'_>) {
        py.detach(|| *lock(&self.device) = None);
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (kind, error, traceback))]
    fn __exit__(
        &self,
        py: Python<'_>,
        kind: Option<&Bound<'_, PyAny>>,
        error: Option<&Bound<'_, PyAny>>,
        traceback: Option<&Bound<'_, PyAny>>,
    ) {
        let _ = (kind, error, traceback);
        self.close(py);
    }

    fn __repr__(&self) -> String {
        format!("<Balance {}>", self.name)
    }
}

impl Balance {
    fn of(device: impl DoseBalance + 'static, wait: Duration, name: String) -> Self {
        Self { device: Arc::new(Mutex::new(Some(Box::new(device)))), wait, name }
    }

    /// Returns the device, unless it is closed. One that is in use is not closed.
    pub(super) fn device(&self) -> PyResult<Device> {
        match self.device.try_lock() {
            Ok(device) if device.is_none() => Err(closed()),
            _ => Ok(Arc::clone(&self.device)),
        }
    }
}

/// Locks a device. A panic of the last holder does not matter: the device stays usable.
pub(super) fn lock(device: &Device) -> MutexGuard<'_, Option<Box<dyn DoseBalance>>> {
    device.lock().unwrap_or_else(PoisonError::into_inner)
}

fn closed() -> PyErr {
    PumpError::new_err("this balance is closed; open it again")
}

/// Reads the longest wait for a balance to stand still. `None` is the usual one.
fn wait_of(wait: Option<&Bound<'_, PyAny>>) -> PyResult<Duration> {
    let wait_s = match wait {
        Some(wait) => quantity("wait", "60s", wait, units::time_s)?,
        None => 60.0,
    };
    Ok(Duration::from_secs_f64(wait_s.min(MOST_WAIT_S)))
}

/// Balance that a Python function reads.
struct FunctionBalance {
    read: Py<PyAny>,
    name: String,
}

impl Debug for FunctionBalance {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.debug_struct("FunctionBalance").field("name", &self.name).finish_non_exhaustive()
    }
}

impl DoseBalance for FunctionBalance {
    fn read_still(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        agreeing(longest, stop, || self.read_now(longest, stop))
    }

    fn read_now(&mut self, _: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        if stop.is_made() {
            return Err(BalanceError::Stopped);
        }
        let said = Python::attach(|py| self.read.call0(py)?.extract::<String>(py));
        let failed = |error: PyErr| BalanceError::ProgramFailed {
            command: self.name.clone(),
            said: error.to_string(),
        };
        printed_reading(&said.map_err(failed)?)
    }
}
