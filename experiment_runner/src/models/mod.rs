//! The friction models for people: what there is, what the parameters mean, and parameter files of
//! one model.

pub mod file;
pub mod sheet;

use friction_model::{AnyParameters, ModelName};
use serde_json::{Map, Value};

/// A set of parameters that every model has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Preset {
    /// The thesis's test bed: N m, rad, s.
    #[default]
    TestBed,
    /// The thesis's chapter 3: N, m, s.
    #[value(name = "chapter-3")]
    Chapter3,
}

impl Preset {
    /// The parameters of the model of that name.
    #[must_use]
    pub fn parameters(self, name: ModelName) -> AnyParameters {
        match self {
            Self::TestBed => AnyParameters::test_bed(name),
            Self::Chapter3 => AnyParameters::chapter_3(name),
        }
    }

    const fn title(self) -> &'static str {
        match self {
            Self::TestBed => "test bed",
            Self::Chapter3 => "chapter 3",
        }
    }

    /// Option that chooses it, where it is not chosen anyway.
    const fn option(self) -> &'static str {
        match self {
            Self::TestBed => "",
            Self::Chapter3 => " --set chapter-3",
        }
    }
}

/// The parameters by name, as files carry them: numbers, whole numbers, lists, and null for what is
/// left out.
fn values(parameters: &AnyParameters) -> Map<String, Value> {
    let under_the_name = serde_json::to_value(parameters).ok();
    let inner = under_the_name.and_then(|tree| tree.get(parameters.name().as_str()).cloned());
    inner.and_then(|tree| tree.as_object().cloned()).unwrap_or_default()
}
