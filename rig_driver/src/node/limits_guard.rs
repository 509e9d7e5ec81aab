//! Who may change what the safety layer allows, and when.

use std::collections::BTreeSet;

use ros_node::parameters::Values;

use super::parameters::is_simulated;

/// The parameter that lets limits of a real rig be changed after the start.
pub(super) const ALLOW_LIMITS: &str = "allow_limits";

/// Whether a parameter says what the safety layer allows, or what it sees.
pub(super) fn is_limit(name: &str) -> bool {
    matches!(name, "rig" | "voltage_limit")
        || name.starts_with("safety.")
        || name.starts_with("calibration.")
}

/// Judges changes of limits. The first values it sees are those that the program was started with.
#[derive(Debug, Default)]
pub(super) struct LimitsGuard {
    before: Option<Values>,
    real: bool,
}

impl LimitsGuard {
    /// Whether `values` may follow those from before; `moves` says whether the motor may move now.
    /// Values that stay the same are no change.
    ///
    /// # Errors
    /// The reason, for people.
    pub(super) fn judge(
        &self,
        values: &Values,
        changed: &BTreeSet<String>,
        moves: bool,
    ) -> Result<(), String> {
        let Some(before) = &self.before else { return Ok(()) };
        let changes = |name: &&String| is_limit(name) && values.get(name) != before.get(name);
        let Some(name) = changed.iter().find(changes) else { return Ok(()) };
        if moves {
            return Err(format!(
                "{name} cannot be set while the node is active: it is a limit; deactivate the node first"
            ));
        }
        if before.boolean(ALLOW_LIMITS) {
            return Ok(());
        }
        if self.real {
            return Err(format!(
                "{name} cannot be set: the limits of a real rig are those that the program was started with; give it then, or start with -p {ALLOW_LIMITS}:=true"
            ));
        }
        if name == "rig" {
            return Err(format!(
                "rig cannot be set: the program was started with a simulated one; start it with the rig that is meant, or with -p {ALLOW_LIMITS}:=true"
            ));
        }
        Ok(())
    }

    /// Takes values that were good.
    pub(super) fn take(&mut self, values: &Values) {
        if self.before.is_none() {
            self.real = !is_simulated(values.text("rig"));
        }
        self.before = Some(values.clone());
    }
}

#[cfg(test)]
mod tests {
    use std::{
        cell::Cell,
        collections::BTreeMap,
        sync::{
            Arc,
            atomic::{AtomicBool, Ordering},
        },
    };

    use ros_node::{
        ParameterValue,
        parameters::{Change, ParameterStore},
    };

    use super::*;

    struct Node {
        store: ParameterStore,
        moves: Arc<AtomicBool>,
        asked: Cell<u32>,
    }

    fn node(given: &[(&str, ParameterValue)]) -> Node {
        let given: BTreeMap<_, _> =
            given.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        let moves = Arc::new(AtomicBool::new(false));
        let (mut guard, seen) = (LimitsGuard::default(), Arc::clone(&moves));
        let judge = Box::new(move |values: &Values, changed: &BTreeSet<String>| {
            guard.judge(values, changed, seen.load(Ordering::Relaxed))?;
            guard.take(values);
            Ok(())
        });
        let store =
            ParameterStore::new(super::super::declarations("simulated"), &given, judge).unwrap();
        Node { store, moves, asked: Cell::new(0) }
    }

    impl Node {
        fn set(&mut self, name: &str, value: ParameterValue) -> Result<(), String> {
            self.asked.set(self.asked.get() + 1);
            let set = self.store.set(&[Change { name: name.to_owned(), value }]);
            set.map_err(|error| error.to_string())
        }
    }

    const REAL: (&str, &str) = ("rig", "serial:/dev/ttyACM0");

    fn text(value: &str) -> ParameterValue {
        ParameterValue::String(value.to_owned())
    }

    fn each() -> Vec<(&'static str, ParameterValue)> {
        vec![
            ("safety.slew", ParameterValue::Double(1e9)),
            ("safety.velocity", ParameterValue::Double(1e9)),
            ("safety.command_age", ParameterValue::Double(0.1)),
            ("voltage_limit", ParameterValue::Double(10.0)),
            ("rig", text("quanser")),
            ("calibration.tachometer_gain", ParameterValue::Double(1e-9)),
        ]
    }

    #[test]
    fn the_limits_of_a_real_rig_stay_those_of_the_start() {
        let mut node = node(&[(REAL.0, text(REAL.1))]);
        for (name, value) in each() {
            let why = node.set(name, value).unwrap_err();
            assert!(why.starts_with(name) && why.contains(ALLOW_LIMITS), "{why}");
        }
        node.set("voltage_limit", ParameterValue::Double(6.0))
            .expect("the same value is no change");
        node.set("torque_filter", ParameterValue::Double(0.02)).expect("no limit");
        let why = node.set(ALLOW_LIMITS, ParameterValue::Boolean(true)).unwrap_err();
        assert!(why.contains("read-only"), "{why}");
    }

    #[test]
    fn who_started_it_so_may_change_them_at_rest_but_not_while_it_is_active() {
        let mut node =
            node(&[(REAL.0, text(REAL.1)), (ALLOW_LIMITS, ParameterValue::Boolean(true))]);
        node.moves.store(true, Ordering::Relaxed);
        for (name, value) in each() {
            let why = node.set(name, value).unwrap_err();
            assert!(why.contains("while the node is active"), "{why}");
        }
        node.moves.store(false, Ordering::Relaxed);
        for (name, value) in each() {
            node.set(name, value).unwrap();
        }
    }

    #[test]
    fn a_simulated_rig_may_be_changed_at_rest_but_does_not_become_a_real_one() {
        let mut node = node(&[]);
        for (name, value) in each() {
            assert_eq!(node.set(name, value).is_ok(), name != "rig", "{name}");
        }
        node.moves.store(true, Ordering::Relaxed);
        assert!(node.set("safety.slew", ParameterValue::Double(5.0)).is_err());
    }

    /// The motor is at zero volts within the stated time after commands or cycles cease, whatever
    /// is set.
    #[test]
    fn no_parameter_stretches_the_promise() {
        for (name, limit) in [
            ("safety.command_age", 0.1),
            ("safety.command_lost", 1.0),
            ("safety.cycle_late", 1.0),
            ("safety.cycle_lost", 1.0),
        ] {
            let mut node = node(&[]);
            assert!(node.set(name, ParameterValue::Double(limit * 1.001)).is_err(), "{name}");
            node.set(name, ParameterValue::Double(limit)).unwrap();
        }
    }
}
