//! The types that a node uses, and what it answers whoever asks for one of them: the service
//! `~/get_type_description`, as rcl has it.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

use msgs::descriptions::{self, DefinitionError, Described};
use msgs::type_description_interfaces::{
    GetTypeDescriptionRequest, GetTypeDescriptionResponse, TypeDescription,
};

/// The service, as the code calls it.
pub(crate) const SERVICE: &str = "~/get_type_description";
/// The parameter that every node has: whether the service is there.
pub(crate) const WANTED: &str = "start_type_description_service";

/// The types of a node's endpoints, by their hashes.
#[derive(Default)]
pub(crate) struct Types(Mutex<BTreeMap<String, Described>>);

impl Types {
    /// An endpoint of that type. One whose definition cannot be read is used all the same: nobody
    /// but whoever asks for it misses its description.
    pub(crate) fn uses(&self, described: Result<Described, DefinitionError>) {
        if let Ok(described) = described {
            self.known().entry(described.hash.clone()).or_insert(described);
        }
    }

    /// As [`uses`](Self::uses), of a type of `msgs` by its full name.
    pub(crate) fn uses_named(&self, name: &str) {
        if let Some(described) = descriptions::all().get(name) {
            self.uses(Ok(described.clone()));
        }
    }

    /// What rcl answers. The hash decides, not the name.
    pub(crate) fn answer(&self, asked: &GetTypeDescriptionRequest) -> GetTypeDescriptionResponse {
        let refused = |reason: &str| GetTypeDescriptionResponse {
            failure_reason: reason.to_owned(),
            ..GetTypeDescriptionResponse::default()
        };
        if !is_hash(&asked.type_hash) {
            return refused("Failed to parse type hash");
        }
        let known = self.known();
        let Some(described) = known.get(&asked.type_hash) else {
            return refused("Type not currently in use by this node");
        };
        let sources = asked.include_type_sources.then(|| described.sources.clone());
        GetTypeDescriptionResponse {
            successful: true,
            failure_reason: String::new(),
            type_description: TypeDescription::clone(&described.description),
            type_sources: sources.unwrap_or_default(),
            extra_information: Vec::new(),
        }
    }

    fn known(&self) -> MutexGuard<'_, BTreeMap<String, Described>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether it is the hash of some type.
fn is_hash(text: &str) -> bool {
    text.strip_prefix("RIHS01_").is_some_and(|digits| {
        digits.len() == 64 && digits.bytes().all(|digit| digit.is_ascii_hexdigit())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use msgs::{RosMessage, sensor_msgs::JointState, std_srvs::Trigger};

    fn ask(hash: &str, sources: bool) -> GetTypeDescriptionRequest {
        GetTypeDescriptionRequest {
            type_name: "another/msg/Name".into(),
            type_hash: hash.into(),
            include_type_sources: sources,
        }
    }

    #[test]
    fn what_the_node_uses_is_described_by_its_hash() {
        let types = Types::default();
        types.uses(descriptions::message::<JointState>());
        types.uses(descriptions::service::<Trigger>());
        types.uses_named("rcl_interfaces/msg/ParameterEvent");
        types.uses_named("no/such/Type");
        let told = types.answer(&ask(JointState::TYPE_HASH, true));
        assert!(told.successful && told.failure_reason.is_empty(), "{told:?}");
        assert_eq!(told.type_description.type_description.type_name, "sensor_msgs/msg/JointState");
        assert_eq!(told.type_sources.len(), 3);
        assert_eq!(types.answer(&ask(JointState::TYPE_HASH, false)).type_sources, []);
        assert_eq!(types.known().len(), 3);
    }

    #[test]
    fn what_it_does_not_use_and_what_is_no_hash_is_refused_as_rcl_refuses_it() {
        let types = Types::default();
        let unused = types.answer(&ask(JointState::TYPE_HASH, true));
        assert_eq!(unused.failure_reason, "Type not currently in use by this node");
        let digits = "0".repeat(64);
        for text in ["", "RIHS01_", "RIHS01_00", &digits, &format!("RIHS02_{digits}"), "RIHS01_é"]
        {
            let told = types.answer(&ask(text, true));
            assert!(!told.successful);
            assert_eq!(told.failure_reason, "Failed to parse type hash", "{text}");
        }
    }
}
