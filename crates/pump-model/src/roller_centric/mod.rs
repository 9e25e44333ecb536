//! The segment-resolved roller-centric model: every roller a valve, every segment of tube between two rollers a chamber.
//! Experimental.
//!
//! Follows the idea of Moscato et al., Med. Eng. Phys. 30 (2008) 1149-1158, as far as McIntyre et al. tell of it; the
//! equations are a reconstruction. Roller k stands at p_k = theta - k pitch and touches the tube for
//! -Lam - phi < p_k < phi, Lam = pi + 2 beta - 2 inset. With a the nominal flow per radian, l the roller in contact that is
//! nearest to the outlet and m the one nearest to the inlet:
//!
//! ```text
//! V0_in  = s a (p_m + Lam + phi) - V_m/2        V0_out = s a (phi - p_l) - V_l/2
//! V0_seg = s a pitch - (V_k + V_k+1)/2          what a chamber holds: V0 (1 + D (P - P_atm))
//!
//! (C_in + D V0_in) dP_in/dt    = Q_Lin - q_m        - V0_in'  (1 + D (P_in - P_atm))
//! (C_out + D V0_out) dP_out/dt = q_l - Q_Lout       - V0_out' (1 + D (P_out - P_atm))
//! D V0_seg dP/dt               = q_behind - q_ahead - V0_seg' (1 + D (P - P_atm))
//!
//! q_k = G_k (P_behind - P_ahead),  G = (1 - u)^3/R_v for u < 1, else 0
//! ```
//!
//! and the lines as in the flow-centric model. Assumptions, none of which anybody has measured:
//!
//! - The volume V_k that a roller displaces is taken half from the chamber in front of it and half from that behind.
//! - Chambers swell in proportion to their volume and to the pressure above ambient; the wall has no inertia and no delay.
//! - A segment has one pressure: no wave, no friction and no inertia inside.
//! - A roller closes with the cube of what is left of the way to theta_c, u = x/theta_c, and opens the same way. Once closed it
//!   lets nothing pass, at any pressure.
//! - The flow past a roller is proportional to the pressure across it.
//! - A tube that is sucked empty does not collapse, and nothing cavitates.
//! - A roller that comes into contact at the inlet cuts off a segment at the inlet's pressure; one that leaves at the outlet
//!   joins its segment with the outlet, and what both hold stays the same. In reverse inlet and outlet swap roles.
//! - At rest a segment that is open to a port has the pressure of its reservoir, a closed one that of the inlet's.
//! - s and D are those of the speed law, fitted to published summary numbers; R_v is a guess. Closing is gradual, so a segment
//!   is as good as cut off before theta_c: with two or three rollers a revolution delivers 1 to 3 % more than the speed law.
//!
//! Where many rollers leave little room between them, the volume that they displace after they have closed has nowhere to go:
//! with eight rollers of the pump of McIntyre et al. at 100 r/min a segment reaches -14 and 267 kPa, with twelve 2,100 kPa.

mod chambers;
mod contacts;
mod run;
mod steady;

pub use run::{RollerRun, RollerSample};

use crate::error::{ModelError, positive};
use crate::math::TURN_RAD;
use crate::pump::Pump;

/// What the roller-centric model needs to know beyond the [`Pump`]. Experimental: the module's documentation lists what it assumes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RollerCentric {
    /// s, 0.5 to 2: volume between two rollers over that of the round tube.
    pub scale: f64,
    /// D, 1/kPa, 1e-9 to 1: how much more a chamber holds for more pressure.
    pub distensibility_per_kpa: f64,
    /// R_v, kPa s/mL, 1e-9 to 1e3: what a roller that only just touches the tube resists.
    pub valve_resistance_kpa_s_ml: f64,
    /// theta_c, rad, up to phi: where an engaging roller has closed the lumen.
    pub closure_rad: f64,
    /// P_atm, kPa absolute.
    pub ambient_kpa: f64,
}

impl RollerCentric {
    /// For the pump of McIntyre et al.: s and D as fitted to what they publish, theta_c of the dimensions of their Table 1, an
    /// R_v of 1e-3 kPa s/mL, which is small against what a line resists.
    pub const PUBLISHED: Self = Self {
        scale: 0.953,
        distensibility_per_kpa: 2.05e-3,
        valve_resistance_kpa_s_ml: 1e-3,
        closure_rad: 30.692_584 * (TURN_RAD / 360.0),
        ambient_kpa: 85.7,
    };

    /// For any pump: as [`Self::PUBLISHED`], with theta_c of its dimensions ([`crate::Drawing::closure_rad`]) and the ambient
    /// pressure, kPa absolute. Refuses dimensions from which no theta_c follows.
    #[cfg(feature = "identification")]
    pub fn of(pump: &Pump, ambient_kpa: f64) -> Result<Self, ModelError> {
        let closure_rad = crate::drawing::Drawing::new(pump.geometry())?.closure_rad();
        let model = Self { closure_rad, ambient_kpa, ..Self::PUBLISHED };
        model.validate(pump)?;
        Ok(model)
    }

    /// Refuses parameters that are not physical, or not so for `pump`.
    pub fn validate(&self, pump: &Pump) -> Result<(), ModelError> {
        let refused = |parameter, value, allowed| Err(ModelError::OutOfRange { parameter, value, allowed });
        if !(0.5..=2.0).contains(&self.scale) {
            return refused("scale of the segments", self.scale, "0.5 to 2");
        }
        if !(1e-9..=1.0).contains(&self.distensibility_per_kpa) {
            return refused("distensibility in 1/kPa", self.distensibility_per_kpa, "1e-9 to 1");
        }
        if !(1e-9..=1e3).contains(&self.valve_resistance_kpa_s_ml) {
            return refused(
                "resistance of an open roller in kPa s/mL",
                self.valve_resistance_kpa_s_ml,
                "1e-9 to 1e3",
            );
        }
        positive("closure angle in rad", self.closure_rad)?;
        if self.closure_rad > pump.roller_volume().engagement_rad() {
            return refused(
                "closure angle in rad",
                self.closure_rad,
                "no more than the engagement angle phi; give one where the dimensions' is larger than a measured phi",
            );
        }
        positive("ambient pressure in kPa absolute", self.ambient_kpa)?;
        // A segment between two engaged rollers is the smallest.
        let segment_ml =
            self.scale * pump.nominal_ml_rad() * pump.pitch_rad() - pump.roller_volume().total_ml();
        if segment_ml <= 0.0 {
            return refused(
                "volume between two rollers in mL",
                segment_ml,
                "a positive number: a larger scale or fewer rollers",
            );
        }
        Ok(())
    }
}
