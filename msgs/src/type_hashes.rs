//! Hashes of the types that the laboratory's endpoints carry, by their names: what ROS announces
//! beside each reader and writer.

use std::{collections::BTreeMap, sync::LazyLock};

use crate::descriptions;

static ALL: LazyLock<BTreeMap<String, &'static str>> = LazyLock::new(|| {
    let described = descriptions::all().iter();
    described.map(|(name, described)| (name.clone(), described.hash.as_str())).collect()
});

/// Names, as in `std_srvs/srv/Trigger_Request`, with the hashes of the types (`RIHS01_...`).
#[must_use]
pub fn all() -> &'static BTreeMap<String, &'static str> {
    &ALL
}

/// The hash of a type that DDS calls so, as in `std_srvs::srv::dds_::Trigger_Request_`; `None` if
/// it is none of the laboratory's.
#[must_use]
pub fn of_dds(type_name: &str) -> Option<&'static str> {
    let (folder, name) = type_name.strip_suffix('_')?.split_once("::dds_::")?;
    ALL.get(&format!("{}/{name}", folder.replace("::", "/"))).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RosMessage, friction_msgs::Reference, std_srvs::TriggerRequest};

    #[test]
    fn a_hash_is_found_by_the_name_that_dds_has() {
        assert_eq!(
            of_dds("std_srvs::srv::dds_::Trigger_Request_"),
            Some(TriggerRequest::TYPE_HASH)
        );
        assert_eq!(of_dds("friction_msgs::msg::dds_::Reference_"), Some(Reference::TYPE_HASH));
        let goal = "friction_msgs/action/RunExperiment_SendGoal_Request";
        assert_eq!(
            of_dds("friction_msgs::action::dds_::RunExperiment_SendGoal_Request_"),
            Some(all()[goal])
        );
        for unknown in
            ["", "_", "std_srvs/srv/Trigger_Request", "std_msgs::msg::dds_::Empty_", "::dds_::_"]
        {
            assert_eq!(of_dds(unknown), None, "{unknown}");
        }
    }
}
