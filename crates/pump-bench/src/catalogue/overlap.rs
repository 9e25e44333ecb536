//! The warning of rollers that overlap in space.

use pump_model::Geometry;

/// Returns the warning of a head whose neighbouring rollers overlap. `None` if they do not.
///
/// The model computes such a head. Nobody can build it, so a dimension or the number of rollers is wrong.
///
/// ```
/// use pump_model::{Geometry, Variant};
/// let warning = pump_bench::catalogue::overlap_warning(&Geometry::published(8, Variant::Measured)).unwrap();
/// assert!(warning.contains("30.61 mm apart"));
/// ```
pub fn overlap_warning(geometry: &Geometry) -> Option<String> {
    let depth_mm = geometry.rollers_overlap_mm()?;
    let diameter_mm = 2.0 * geometry.roller_radius_mm;
    let apart_mm = diameter_mm - depth_mm;
    Some(format!(
        "the rollers overlap by {depth_mm:.2} mm: their axes stand {apart_mm:.2} mm apart, less than their diameter of \
         {diameter_mm:.2} mm; check the roller's radius, the offset and the number of rollers"
    ))
}
