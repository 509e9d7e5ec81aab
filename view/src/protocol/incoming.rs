//! What viewers say in JSON.

use serde::Deserialize;

use crate::Parameter;

/// One thing that a viewer says.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub(crate) enum Said {
    /// Wants messages of channels.
    Subscribe { subscriptions: Vec<Subscription> },
    /// Wants them no more.
    Unsubscribe { subscription_ids: Vec<u32> },
    /// Will send messages of its own.
    Advertise { channels: Vec<Own> },
    /// Will send no more.
    Unadvertise { channel_ids: Vec<u32> },
    /// Asks for values.
    GetParameters { parameter_names: Vec<String>, id: Option<String> },
    /// Wants other values.
    SetParameters { parameters: Vec<Parameter>, id: Option<String> },
    /// Wants to hear of changes.
    SubscribeParameterUpdates { parameter_names: Vec<String> },
    /// Wants to hear no more.
    UnsubscribeParameterUpdates { parameter_names: Vec<String> },
}

/// A subscription.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Subscription {
    /// A number of the viewer's own.
    pub(crate) id: u32,
    pub(crate) channel_id: u32,
}

/// A channel of the viewer's own.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(crate) struct Own {
    pub(crate) id: u32,
    pub(crate) topic: String,
    pub(crate) encoding: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_specification_shows_is_read() {
        let said = |text: &str| serde_json::from_str::<Said>(text).unwrap();
        assert_eq!(
            said(r#"{"op":"subscribe","subscriptions":[{"id":0,"channelId":3}]}"#),
            Said::Subscribe { subscriptions: vec![Subscription { id: 0, channel_id: 3 }] }
        );
        assert_eq!(
            said(r#"{"op":"getParameters","parameterNames":["/a.b"],"id":"x"}"#),
            Said::GetParameters { parameter_names: vec!["/a.b".into()], id: Some("x".into()) }
        );
        assert!(matches!(
            said(r#"{"op":"setParameters","parameters":[{"name":"/a.b","value":3}]}"#),
            Said::SetParameters { id: None, .. }
        ));
        assert!(matches!(
            said(
                r#"{"op":"advertise","channels":[{"id":1,"topic":"/t","encoding":"json","schemaName":"T"}]}"#
            ),
            Said::Advertise { .. }
        ));
    }
}
