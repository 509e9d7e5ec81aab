//! Types described as ROS describes them (REP 2016): their fields, the types that they refer to,
//! the files they stand in, and the hash of it all. It is what a node's service
//! `~/get_type_description` answers.
//!
//! ```
//! use msgs::{RosMessage, descriptions, friction_msgs::Reference, std_srvs::Trigger};
//!
//! # fn main() -> Result<(), descriptions::DefinitionError> {
//! let described = descriptions::message::<Reference>()?;
//! assert_eq!(described.hash, Reference::TYPE_HASH);
//! assert_eq!(described.description.type_description.fields[1].name, "position");
//! // A service is a type too: of a request, a response, and the event that tells of both.
//! let service = descriptions::service::<Trigger>()?;
//! assert_eq!(service.description.type_description.type_name, "std_srvs/srv/Trigger");
//! # Ok(())
//! # }
//! ```

mod files;
mod hash;
mod library;
mod parse;

use std::{collections::BTreeMap, sync::LazyLock};

use crate::{
    Definition, RosAction, RosMessage, RosService,
    type_description_interfaces::{TypeDescription, TypeSource},
};
use library::Library;

/// A type, described.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Described {
    /// The type, and those that it refers to.
    pub description: TypeDescription,
    /// The texts of their files, the type's own first. Those of standard packages say the same as
    /// the files of ROS, in fewer words.
    pub sources: Vec<TypeSource>,
    /// Hash of the structure, `RIHS01_...`.
    pub hash: String,
}

/// A definition that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DefinitionError {
    /// A line is none of a definition.
    #[error(
        "`{line}` is no line of a definition: {why}; write `type name`, as in `float64[] position`"
    )]
    Line {
        /// The line.
        line: String,
        /// What is wrong.
        why: &'static str,
    },
    /// A type that is referred to is not there.
    #[error("the type {0} is not known; name it among the DEPENDENCIES of what refers to it")]
    Unknown(String),
}

static STANDARD: LazyLock<Library> = LazyLock::new(files::library);

static ALL: LazyLock<BTreeMap<String, Described>> = LazyLock::new(|| {
    let described = STANDARD.names().filter_map(|name| {
        STANDARD.describe(name).ok().map(|described| (name.to_owned(), described))
    });
    described.collect()
});

/// Every type that this crate has a definition of, by its full name, as in
/// `rcl_interfaces/srv/GetParameters`; the types that services and actions are made of are among
/// them.
#[must_use]
pub fn all() -> &'static BTreeMap<String, Described> {
    &ALL
}

/// A message, anybody's.
///
/// # Errors
/// [`DefinitionError`] for a definition that cannot be read, or refers to a type that is not there.
pub fn message<M: RosMessage>() -> Result<Described, DefinitionError> {
    let mut library = Library::before(&STANDARD);
    add(&mut library, M::DEPENDENCIES)?;
    let name = M::type_name();
    if M::FOLDER == "msg" {
        add(&mut library, &[M::DEFINITION])?;
    } else {
        library.add_part(&name, M::DEFINITION.package, M::DEFINITION.text)?;
    }
    library.describe(&name)
}

/// A service, anybody's.
///
/// # Errors
/// As of [`message`].
pub fn service<S: RosService>() -> Result<Described, DefinitionError> {
    let mut library = Library::before(&STANDARD);
    add(&mut library, S::Request::DEPENDENCIES)?;
    add(&mut library, S::Response::DEPENDENCIES)?;
    let parts = [S::Request::DEFINITION.text, S::Response::DEFINITION.text];
    library.add_service(S::PACKAGE, S::NAME, parts)?;
    library.describe(&format!("{}/srv/{}", S::PACKAGE, S::NAME))
}

/// An action, anybody's, and what its endpoints carry: the two services and the message of its
/// feedback.
///
/// # Errors
/// As of [`message`].
pub fn action<A: RosAction>() -> Result<[Described; 4], DefinitionError> {
    let mut library = Library::before(&STANDARD);
    add(&mut library, A::Goal::DEPENDENCIES)?;
    add(&mut library, A::Result::DEPENDENCIES)?;
    add(&mut library, A::Feedback::DEPENDENCIES)?;
    let parts =
        [A::Goal::DEFINITION.text, A::Result::DEFINITION.text, A::Feedback::DEFINITION.text];
    library.add_action(A::PACKAGE, A::NAME, parts)?;
    let of = |part: &str| library.describe(&format!("{}/action/{}{part}", A::PACKAGE, A::NAME));
    Ok([of("")?, of("_SendGoal")?, of("_GetResult")?, of("_FeedbackMessage")?])
}

fn add(library: &mut Library, definitions: &[Definition]) -> Result<(), DefinitionError> {
    definitions.iter().try_for_each(|own| library.add_message(own.package, own.name, own.text))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{friction_msgs::RunExperiment, sensor_msgs::JointState, std_srvs::Trigger};

    /// Hashes that rclpy 9.1.2 tells of its own endpoints.
    #[test]
    fn hashes_are_those_of_ros() {
        for (name, hash) in [
            (
                "sensor_msgs/msg/JointState",
                "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
            ),
            (
                "std_srvs/srv/Trigger",
                "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
            ),
            (
                "rcl_interfaces/msg/ParameterEvent",
                "RIHS01_043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204",
            ),
        ] {
            assert_eq!(all()[name].hash, hash, "{name}");
        }
        assert_eq!(message::<JointState>().expect("it is read").hash, JointState::TYPE_HASH);
        assert_eq!(service::<Trigger>().as_ref(), Ok(&all()["std_srvs/srv/Trigger"]));
    }

    #[test]
    fn an_action_is_described_with_what_its_endpoints_carry() {
        let described = action::<RunExperiment>().expect("it is read");
        let names = described.each_ref().map(|one| &*one.description.type_description.type_name);
        let whole = "friction_msgs/action/RunExperiment";
        let parts = ["_SendGoal", "_GetResult", "_FeedbackMessage"].map(|of| whole.to_owned() + of);
        assert_eq!(names, [whole, &parts[0], &parts[1], &parts[2]]);
        for one in &described {
            assert_eq!(one, &all()[&one.description.type_description.type_name]);
        }
        let encodings: Vec<_> = described[0].sources.iter().map(|of| &*of.encoding).collect();
        assert_eq!(encodings[..3], ["action", "msg", "implicit"]);
    }

    /// A message of somebody else's.
    #[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
    struct Foreign;

    impl RosMessage for Foreign {
        const DEFINITION: Definition =
            Definition { package: "own", name: "Foreign", text: "Part[<=2] parts\nLost lost\n" };
        const DEPENDENCIES: &'static [Definition] =
            &[Definition { package: "own", name: "Part", text: "std_msgs/Header header\n" }];
        const TYPE_HASH: &'static str = "";
    }

    #[test]
    fn a_type_that_is_not_there_is_told() {
        let error = message::<Foreign>().expect_err("own/Lost is nowhere");
        assert_eq!(error, DefinitionError::Unknown("own/msg/Lost".to_owned()));
        assert!(error.to_string().contains("DEPENDENCIES"));
    }
}
