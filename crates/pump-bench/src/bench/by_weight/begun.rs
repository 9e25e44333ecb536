//! The part of a dose by weight that an earlier command made.

/// Part of a dose by weight that an earlier command made, by its record and by the balance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BegunByWeight {
    /// Reading before the dose, in g, from the record.
    pub(crate) tare_g: f64,
    /// Reading at rest before the rest of the dose, in g.
    pub(crate) shown_g: f64,
    /// Mass that the balance is to show for the whole dose, in g.
    pub(crate) target_g: f64,
    /// Most volume by the model that the pump may turn for in all, in mL.
    pub(crate) most_ml: f64,
    /// Volume by the model that the dose is booked with so far, in mL.
    pub(crate) turned_ml: f64,
}

impl BegunByWeight {
    /// Returns the mass that the balance shows for the part that was made, in g.
    pub(crate) fn weighed_g(&self) -> f64 {
        self.shown_g - self.tare_g
    }

    /// Returns the mass that the balance lacks, in g. Negative if it shows more than was asked for.
    pub(crate) fn left_g(&self) -> f64 {
        self.target_g - self.weighed_g()
    }
}
