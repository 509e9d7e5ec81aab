//! What viewers are told in JSON.

use serde_json::{Value, json};

use crate::channel::{Channel, ChannelId};
use crate::{Access, Parameter, Service};

/// Level of a status: something went wrong.
pub(crate) const ERROR: u8 = 2;
/// Level of a status: something may go wrong.
pub(crate) const WARNING: u8 = 1;

/// Who speaks, and what it can do. `key` opens the files; `session` differs from start to start.
pub(crate) fn server_info(
    name: &str,
    session: &str,
    access: Access,
    key: &str,
    recording: Option<(u64, u64)>,
) -> String {
    let mut capabilities = vec!["services", "parameters", "parametersSubscribe", "time"];
    if access == Access::Full {
        capabilities.push("clientPublish");
    }
    let mut info = json!({
        "op": "serverInfo",
        "name": name,
        "supportedEncodings": ["json"],
        "metadata": {
            "access": if access == Access::Full { "full" } else { "read-only" },
            "files": format!("/files/{key}/"),
        },
        "sessionId": session,
    });
    if let Some((start, end)) = recording {
        capabilities.push("playbackControl");
        info["dataStartTime"] = stamp(start);
        info["dataEndTime"] = stamp(end);
    }
    info["capabilities"] = json!(capabilities);
    info.to_string()
}

fn stamp(time: u64) -> Value {
    json!({ "sec": time / 1_000_000_000, "nsec": time % 1_000_000_000 })
}

pub(crate) fn advertise(channels: &[(ChannelId, &Channel)]) -> String {
    let all: Vec<Value> = channels
        .iter()
        .map(|(id, channel)| {
            json!({
                "id": id.0,
                "topic": channel.topic,
                "encoding": channel.encoding,
                "schemaName": channel.schema_name,
                "schemaEncoding": channel.schema_encoding,
                "schema": channel.schema,
            })
        })
        .collect();
    json!({ "op": "advertise", "channels": all }).to_string()
}

/// Services are numbered from 1 in the order of the list.
pub(crate) fn advertise_services(services: &[Service]) -> String {
    let all: Vec<Value> = services
        .iter()
        .enumerate()
        .map(|(at, service)| {
            let half = |name: &str, value: &Value| {
                json!({
                    "encoding": "json",
                    "schemaName": format!("{}_{name}", service.kind),
                    "schemaEncoding": "jsonschema",
                    "schema": schema_of(value).to_string(),
                })
            };
            json!({
                "id": at + 1,
                "name": service.name,
                "type": service.kind,
                "request": half("Request", &service.request),
                "response": half("Response", &service.response),
            })
        })
        .collect();
    json!({ "op": "advertiseServices", "services": all }).to_string()
}

/// A JSON schema for values like this one.
fn schema_of(value: &Value) -> Value {
    match value {
        Value::Null => json!({}),
        Value::Bool(_) => json!({ "type": "boolean" }),
        Value::Number(number) if number.is_f64() => json!({ "type": "number" }),
        Value::Number(_) => json!({ "type": "integer" }),
        Value::String(_) => json!({ "type": "string" }),
        Value::Array(all) => {
            json!({ "type": "array", "items": all.first().map_or(json!({}), schema_of) })
        }
        Value::Object(all) => {
            let fields: serde_json::Map<_, _> =
                all.iter().map(|(name, value)| (name.clone(), schema_of(value))).collect();
            json!({ "type": "object", "properties": fields })
        }
    }
}

pub(crate) fn status(level: u8, text: &str, id: Option<&str>) -> String {
    let mut status = json!({ "op": "status", "level": level, "message": text });
    if let Some(id) = id {
        status["id"] = json!(id);
    }
    status.to_string()
}

pub(crate) fn parameter_values(parameters: &[Parameter], id: Option<&str>) -> String {
    let mut values = json!({ "op": "parameterValues", "parameters": parameters });
    if let Some(id) = id {
        values["id"] = json!(id);
    }
    values.to_string()
}

pub(crate) fn call_failed(service: u32, call: u32, why: &str) -> String {
    json!({ "op": "serviceCallFailure", "serviceId": service, "callId": call, "message": why })
        .to_string()
}
