//! Definitions by name, with the types that services and actions are made of.

use std::collections::{BTreeMap, BTreeSet};

use super::{DefinitionError, Described, hash, parse};
use crate::type_description_interfaces::{
    Field, IndividualTypeDescription, TypeDescription, TypeSource,
};

/// A definition as it was read.
struct Entry {
    fields: Vec<Field>,
    encoding: &'static str,
    text: String,
}

/// Definitions by their full names.
#[derive(Default)]
pub(super) struct Library {
    entries: BTreeMap<String, Entry>,
    /// Where else is looked.
    behind: Option<&'static Library>,
}

impl Library {
    /// An empty one in front of another.
    pub(super) fn before(behind: &'static Library) -> Self {
        Self { entries: BTreeMap::new(), behind: Some(behind) }
    }

    /// Its own names.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().map(String::as_str)
    }

    fn get(&self, name: &str) -> Option<&Entry> {
        self.entries.get(name).or_else(|| self.behind.and_then(|behind| behind.get(name)))
    }

    fn put(&mut self, name: String, fields: Vec<Field>, encoding: &'static str, text: String) {
        self.entries.insert(name, Entry { fields, encoding, text });
    }

    /// A type that stands in no file of its own.
    fn imply(&mut self, name: String, fields: Vec<Field>) {
        self.put(name, fields, "implicit", String::new());
    }

    pub(super) fn add_message(
        &mut self,
        package: &str,
        name: &str,
        text: &str,
    ) -> Result<(), DefinitionError> {
        let fields = parse::fields(package, text)?;
        self.put(format!("{package}/msg/{name}"), fields, "msg", as_told(text));
        Ok(())
    }

    /// A part of a service or an action alone.
    pub(super) fn add_part(
        &mut self,
        name: &str,
        package: &str,
        text: &str,
    ) -> Result<(), DefinitionError> {
        self.imply(name.to_owned(), parse::fields(package, text)?);
        Ok(())
    }

    /// A service with the texts of its two parts.
    pub(super) fn add_service(
        &mut self,
        package: &str,
        name: &str,
        parts: [&str; 2],
    ) -> Result<(), DefinitionError> {
        let whole = format!("{package}/srv/{name}");
        let [request, response] = parts.map(|part| parse::fields(package, part));
        let fields = self.parts_of_service(&whole, request?, response?);
        self.put(whole, fields, "srv", as_told(&parts.join("---\n")));
        Ok(())
    }

    /// An action with the texts of its three parts.
    pub(super) fn add_action(
        &mut self,
        package: &str,
        name: &str,
        parts: [&str; 3],
    ) -> Result<(), DefinitionError> {
        let whole = format!("{package}/action/{name}");
        let part = |part: &str| format!("{whole}_{part}");
        for (name, text) in ["Goal", "Result", "Feedback"].into_iter().zip(parts) {
            self.imply(part(name), parse::fields(package, text)?);
        }
        let fields = |text| parse::fields(package, text);
        let goal_id = || fields("unique_identifier_msgs/UUID goal_id");
        let with = |mut fields: Vec<Field>, name, kind| {
            fields.push(parse::nested(name, part(kind)));
            fields
        };
        let send_goal = self.parts_of_service(
            &part("SendGoal"),
            with(goal_id()?, "goal", "Goal"),
            fields("bool accepted\nbuiltin_interfaces/Time stamp")?,
        );
        self.imply(part("SendGoal"), send_goal);
        let get_result = self.parts_of_service(
            &part("GetResult"),
            goal_id()?,
            with(fields("int8 status")?, "result", "Result"),
        );
        self.imply(part("GetResult"), get_result);
        self.imply(part("FeedbackMessage"), with(goal_id()?, "feedback", "Feedback"));
        let all = [
            ("goal", "Goal"),
            ("result", "Result"),
            ("feedback", "Feedback"),
            ("send_goal_service", "SendGoal"),
            ("get_result_service", "GetResult"),
            ("feedback_message", "FeedbackMessage"),
        ];
        let all = all.map(|(name, kind)| parse::nested(name, part(kind))).to_vec();
        self.put(whole, all, "action", as_told(&parts.join("---\n")));
        Ok(())
    }

    /// Adds what a service is made of; returns the fields of the whole.
    fn parts_of_service(
        &mut self,
        whole: &str,
        request: Vec<Field>,
        response: Vec<Field>,
    ) -> Vec<Field> {
        let part = |part: &str| format!("{whole}_{part}");
        let at_most_one = |name, kind| {
            let mut field = parse::nested(name, part(kind));
            field.r#type.type_id += parse::BOUNDED_SEQUENCE;
            field.r#type.capacity = 1;
            field
        };
        let event = vec![
            parse::nested("info", "service_msgs/msg/ServiceEventInfo".to_owned()),
            at_most_one("request", "Request"),
            at_most_one("response", "Response"),
        ];
        self.imply(part("Request"), request);
        self.imply(part("Response"), response);
        self.imply(part("Event"), event);
        let all = [
            ("request_message", "Request"),
            ("response_message", "Response"),
            ("event_message", "Event"),
        ];
        all.map(|(name, kind)| parse::nested(name, part(kind))).to_vec()
    }

    /// A type with all that it refers to.
    pub(super) fn describe(&self, name: &str) -> Result<Described, DefinitionError> {
        let mut referenced = BTreeSet::new();
        let mut ahead = vec![name];
        while let Some(next) = ahead.pop() {
            let entry = self.get(next).ok_or_else(|| DefinitionError::Unknown(next.to_owned()))?;
            for field in &entry.fields {
                let nested = field.r#type.nested_type_name.as_str();
                if !nested.is_empty() && nested != name && referenced.insert(nested) {
                    ahead.push(nested);
                }
            }
        }
        let individual = |name: &str| IndividualTypeDescription {
            type_name: name.to_owned(),
            fields: self.get(name).map_or_else(Vec::new, |entry| entry.fields.clone()),
        };
        let description = TypeDescription {
            type_description: individual(name),
            referenced_type_descriptions: referenced.iter().map(|name| individual(name)).collect(),
        };
        let source = |name: &str| {
            let entry = self.get(name)?;
            Some(TypeSource {
                type_name: name.to_owned(),
                encoding: entry.encoding.to_owned(),
                raw_file_contents: entry.text.clone(),
            })
        };
        let names = std::iter::once(name).chain(referenced.iter().copied());
        let sources = names.filter_map(source).collect();
        let hash = hash::of(&description);
        Ok(Described { description, sources, hash })
    }
}

/// A text as ROS tells it: its lines without the end of the last.
fn as_told(text: &str) -> String {
    text.lines().collect::<Vec<_>>().join("\n")
}
