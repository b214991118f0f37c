//! Units of length: what one unit of a scene is.

/// A unit of length. These are the units that 3MF knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Micrometres.
    Um,
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Inches.
    In,
    /// Feet.
    Ft,
}

impl Unit {
    /// All of them.
    pub const ALL: [Unit; 6] = [Unit::Um, Unit::Mm, Unit::Cm, Unit::M, Unit::In, Unit::Ft];
    /// Their names, for a person.
    pub const NAMES: &str = "um, mm, cm, m, in and ft";

    /// As it is written: `mm`.
    pub fn name(self) -> &'static str {
        match self {
            Unit::Um => "um",
            Unit::Mm => "mm",
            Unit::Cm => "cm",
            Unit::M => "m",
            Unit::In => "in",
            Unit::Ft => "ft",
        }
    }

    /// The unit that is written so.
    pub fn named(name: &str) -> Option<Unit> {
        Unit::ALL.into_iter().find(|unit| unit.name() == name)
    }

    /// Its length in nanometres, which is a whole number for each (an inch is 25.4 mm: the international yard and pound agreement of 1959).
    fn nanometres(self) -> f64 {
        match self {
            Unit::Um => 1e3,
            Unit::Mm => 1e6,
            Unit::Cm => 1e7,
            Unit::M => 1e9,
            Unit::In => 25.4e6,
            Unit::Ft => 304.8e6,
        }
    }

    /// So many of this unit, in another.
    pub fn to(self, other: Unit, value: f64) -> f64 {
        if self == other { value } else { value * self.nanometres() / other.nanometres() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_go_from_unit_to_unit() {
        assert_eq!(Unit::Cm.to(Unit::Mm, 3.0), 30.0);
        assert_eq!(Unit::In.to(Unit::Mm, 2.0), 50.8);
        assert_eq!(Unit::Ft.to(Unit::In, 1.5), 18.0);
        assert_eq!(Unit::Mm.to(Unit::M, 10.0), 0.01);
        assert_eq!(Unit::Um.to(Unit::Um, 0.1), 0.1);
        for unit in Unit::ALL {
            assert_eq!(Unit::named(unit.name()), Some(unit));
            assert!(Unit::NAMES.split([',', ' ']).any(|name| name == unit.name()));
        }
        assert_eq!(Unit::named("mile"), None);
    }
}
