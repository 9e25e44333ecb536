//! The segment-resolved roller-centric model: every roller a valve, every segment of tube between two rollers
//! a chamber. Experimental.
//!
//! Follows the idea of Moscato et al., Med. Eng. Phys. 30 (2008) 1149-1158, as far as McIntyre et al.
//! describe it; the equations are a reconstruction. Roller k stands at p_k = theta - k pitch and touches the
//! tube for -Lam - phi < p_k < phi, Lam = pi + 2 beta - 2 inset. With a the nominal flow per radian, l the
//! roller in contact that is nearest to the outlet and m the one nearest to the inlet:
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
//! The lines are those of the flow-centric model. Nobody has measured any of these assumptions:
//!
//! - The volume V_k that a roller displaces is taken half from the chamber in front of it and half from that
//!   behind.
//! - Chambers swell in proportion to their volume and to the pressure above ambient; the wall has no inertia
//!   and no delay.
//! - A segment has one pressure: no wave, no friction and no inertia inside.
//! - A roller closes with the cube of the rest of the way to theta_c, u = x/theta_c, and opens likewise. A
//!   closed roller lets nothing pass, at any pressure.
//! - The flow past a roller is proportional to the pressure across it.
//! - A tube under suction does not collapse, and nothing cavitates.
//! - A roller that comes into contact at the inlet cuts off a segment at the inlet's pressure.
//! - A roller that leaves at the outlet joins its segment with the outlet, and the sum of their contents
//!   stays. In reverse inlet and outlet swap roles.
//! - At rest a segment that is open to a port has the pressure of its reservoir, a closed one that of the
//!   inlet's.
//! - s and D are those of the speed law, fitted to published summary numbers; R_v is a guess. Closing is
//!   gradual, so a segment is as good as cut off before theta_c: with two or three rollers a revolution
//!   delivers 1 to 3 % more than the speed law.
//!
//! Many rollers leave little room between them, and the volume that they displace after they have closed has
//! nowhere to go. With eight rollers of the pump of McIntyre et al. at 100 r/min a segment reaches -14 and
//! 267 kPa, with twelve 2,100 kPa.

mod chambers;
mod contacts;
pub(crate) mod parameters;
pub(crate) mod run;
mod solver;
mod steady;
mod tally;
