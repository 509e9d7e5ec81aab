//! The list of all kinds of rigs.

use std::str::FromStr;
use std::sync::{Arc, OnceLock};

use super::{AddressError, RigAddress};
use crate::back_end::{Listed, Place, RigFactory};
use crate::quanser::QuanserFactory;
#[cfg(feature = "serial")]
use crate::serial::SerialFactory;
use crate::simulated::SimulatedFactory;

/// Kinds of rigs.
#[derive(Debug, Clone)]
pub struct RigRegistry {
    factories: Vec<Arc<dyn RigFactory>>,
}

/// The rigs of this program, where it has others than the standard ones.
static INSTALLED: OnceLock<RigRegistry> = OnceLock::new();

/// The rigs of this program were installed, or asked for, already.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the rigs of this program are known already; install them once, before any address is read"
)]
pub struct AlreadyInstalled;

impl RigRegistry {
    /// The rigs that this crate drives. A back end joins by one line here.
    #[must_use]
    pub fn standard() -> Self {
        Self { factories: Vec::new() }.with(SimulatedFactory).with(QuanserFactory).with_serial()
    }

    #[cfg(feature = "serial")]
    fn with_serial(self) -> Self {
        self.with(SerialFactory)
    }

    #[cfg(not(feature = "serial"))]
    const fn with_serial(self) -> Self {
        self
    }

    /// The same rigs and one more kind. Of two with the same name the later one counts.
    #[must_use]
    pub fn with(mut self, factory: impl RigFactory + 'static) -> Self {
        self.factories.retain(|other| other.name() != factory.name());
        self.factories.push(Arc::new(factory));
        self
    }

    /// Makes these the rigs of this program: those that every address is read by, in options,
    /// parameters and files.
    ///
    /// # Errors
    /// [`AlreadyInstalled`] where an address was read before.
    pub fn install(self) -> Result<(), AlreadyInstalled> {
        INSTALLED.set(self).map_err(|_| AlreadyInstalled)
    }

    /// The rigs of this program: the standard ones, unless others were installed.
    #[must_use]
    pub fn installed() -> &'static Self {
        INSTALLED.get_or_init(Self::standard)
    }

    /// All kinds.
    pub fn factories(&self) -> impl Iterator<Item = &dyn RigFactory> {
        self.factories.iter().map(AsRef::as_ref)
    }

    /// The rig that `text` names.
    ///
    /// # Errors
    /// [`AddressError`] says what is wrong, and which rigs there are.
    pub fn address(&self, text: &str) -> Result<RigAddress, AddressError> {
        let (kind, place) =
            text.split_once(':').map_or((text, None), |(kind, place)| (kind, Some(place)));
        let refused =
            |why: String| AddressError { text: text.to_owned(), why, expected: self.grammar() };
        let factory = self
            .factories
            .iter()
            .find(|factory| factory.name() == kind)
            .ok_or_else(|| refused("there is no such kind".to_owned()))?;
        let place = match (factory.place(), place) {
            (Place::None, None) => return Ok(RigAddress::new(Arc::clone(factory), None)),
            (Place::None, Some(_)) => {
                return Err(refused(format!("nothing stands behind `{kind}`")));
            }
            (Place::Optional { usual, .. }, None) => usual,
            (Place::Optional { what, .. } | Place::Required { what, .. }, None | Some("")) => {
                return Err(refused(format!("{what} is missing behind `{kind}:`")));
            }
            (_, Some(place)) => place,
        };
        let place = factory.normal(place).map_err(|error| refused(error.0))?;
        Ok(RigAddress::new(Arc::clone(factory), Some(place)))
    }

    /// What an address may be, in a few words: `simulated, quanser[:CARD] or serial:PORT[@BAUD] as
    /// in serial:/dev/ttyACM0`.
    #[must_use]
    pub fn grammar(&self) -> String {
        let forms: Vec<String> = self.factories().map(form).collect();
        match forms.split_last() {
            None => "nothing: this program has no rigs".to_owned(),
            Some((last, [])) => last.clone(),
            Some((last, others)) => format!("{} or {last}", others.join(", ")),
        }
    }

    /// Everything that this machine has at the moment.
    #[must_use]
    pub fn listed(&self) -> Vec<Listed> {
        self.factories().flat_map(RigFactory::listed).collect()
    }
}

/// The form of one kind's addresses.
fn form(factory: &dyn RigFactory) -> String {
    let name = factory.name();
    match factory.place() {
        Place::None => name.to_owned(),
        Place::Optional { what, .. } => format!("{name}[:{what}]"),
        Place::Required { what, example } => format!("{name}:{what} as in {name}:{example}"),
    }
}

impl FromStr for RigAddress {
    type Err = AddressError;

    /// One of the rigs of this program ([`RigRegistry::installed`]).
    fn from_str(text: &str) -> Result<Self, AddressError> {
        RigRegistry::installed().address(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_have_names_of_their_own_and_everything_listed_can_be_named() {
        let registry = RigRegistry::standard();
        let mut names: Vec<_> = registry.factories().map(RigFactory::name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), registry.factories().count());
        for factory in registry.factories() {
            assert!(!factory.about().is_empty() && !factory.name().contains(':'));
            assert!(registry.grammar().contains(factory.name()));
        }
        assert_eq!(registry.listed()[0].address, "simulated");
    }

    #[test]
    #[cfg(feature = "serial")]
    fn addresses_are_read_by_name_and_written_back_the_same() {
        let registry = RigRegistry::standard();
        for text in [
            "simulated",
            "quanser:0",
            "quanser:1@tcpip://rig:18920",
            "serial:/dev/ttyACM0",
            "serial:/dev/ttyUSB1@115200",
        ] {
            assert_eq!(registry.address(text).unwrap().to_string(), text);
        }
        assert_eq!(registry.address("quanser").unwrap().to_string(), "quanser:0");
        let usual = registry.address("serial:/dev/ttyACM0@2000000").unwrap();
        assert_eq!(usual, registry.address("serial:/dev/ttyACM0").unwrap());
        for (wrong, why) in [
            ("", "no such kind"),
            ("serial", "PORT"),
            ("serial:", "PORT"),
            ("serial:@9600", "port"),
            ("serial:/dev/x@fast", "`fast` is no baud rate"),
            ("quanser:", "CARD"),
            ("simulated:1", "nothing stands behind"),
            ("usb", "no such kind"),
        ] {
            let said = registry.address(wrong).unwrap_err().to_string();
            assert!(said.contains(why) && said.contains("serial:/dev/ttyACM0"), "{said}");
        }
    }
}
