// McIntyre et al., 3 rollers (three-roller), for the crates pump-model and pump-ctl 0.1.0.
// This source was written from a pump file. Change the pump file, not this source.
// Units: mm, rad, mL, kPa, s.

const _: () = assert!(
    pump_model::generated::FORMAT == 1 && pump_ctl::generated::FORMAT == 2,
    "other versions of pump-model and pump-ctl wrote this source: \
     print it anew with `dose pumps show NAME --format rust`"
);

use pump_ctl::plan::{Limits, Lowest, Motor, PressureLimits, SetBy};
use pump_model::generated::{flow_curve, pump, roller_volume};
use pump_model::{Geometry, Line, Pump};

/// Model of the pump.
#[rustfmt::skip]
pub static PUMP: Pump = pump(
    Geometry {
        rollers: 3,
        bore_radius_mm: 5.0,
        tube_outer_radius_mm: 7.0,
        backplate_radius_mm: 63.0,
        contact_angle_rad: 0.5235987755982988,
        roller_radius_mm: 20.0,
        roller_offset_mm: 40.0,
    },
    roller_volume(0.8819148710327347, 0.0, 2.105466465212997, &[
        (0.0, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        (0.00989991375124977, [0.0, 1.3877787807814457e-17, 9.111001445623494, -2.166400649496864,
            -12.940684255699393, 8.124423689025868]),
    ]),
    [
        Line {
            resistance_kpa_s_ml: 0.1108,
            compliance_ml_kpa: 0.0361,
            inertance_kpa_s2_ml: 0.0042,
            reservoir_kpa: 88.637,
        },
        Line {
            resistance_kpa_s_ml: 0.1108,
            compliance_ml_kpa: 0.0361,
            inertance_kpa_s2_ml: 0.0042,
            reservoir_kpa: 88.637,
        },
    ],
    [
        flow_curve(2.0943951023931953, 7.106164309137073, &[
            (0.0, 1.2223801451117104, [0.0, 4.398229715025711, 0.0, 0.0, 0.0, 0.0]),
            (1.2223801451117104, 0.8720149572814848, [5.376308677287765, 4.3982297150257095,
                -9.111001445623494, 2.1664006494968695, 12.940684255699393, -8.124423689025868]),
        ]),
        flow_curve(2.0943951023931953, 7.106164309137071, &[
            (0.0, 0.8720149572814849, [0.0, 4.2850658053900315, -1.7256035795130638, -14.474655574986834,
                22.48241062491349, -8.124423689025868]),
            (0.8720149572814849, 1.2223801451117104, [1.729855631849306, 4.398229715025711, 0.0, 0.0, 0.0,
                0.0]),
        ]),
    ],
)
.expect("the curves of the pump are whole");

/// Limits of every dose: motor, pressures and torque.
pub static LIMITS: Limits = Limits::new(Motor::new(12800.0, 17.80235837034216, 500.0))
    .with_pressures(PressureLimits { max_outlet_kpa: None, min_inlet_kpa: None })
    .with_lowest(Lowest { kpa: 43.05306302486196, set_by: SetBy::TubeCollapse });
