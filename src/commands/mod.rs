//! The commands, a file each.

pub(crate) mod batch;
pub(crate) mod calibrate;
pub(crate) mod dose;
pub(crate) mod home;
pub(crate) mod identify;
pub(crate) mod mark;
pub(crate) mod new_pump;
pub(crate) mod pumps;
pub(crate) mod simulate;
pub(crate) mod status;
