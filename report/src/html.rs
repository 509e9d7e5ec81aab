//! The only two ways by which foreign text gets into the page.

use std::fmt::Write;

/// Text as it may stand between tags and in quoted attributes.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// Text for reading: escaped, with what stands between two backticks set as code.
pub(super) fn prose(text: &str) -> String {
    let escaped = escape(text);
    let parts: Vec<&str> = escaped.split('`').collect();
    let mut out = String::with_capacity(escaped.len());
    for (index, part) in parts.iter().enumerate() {
        let closed = index + 1 < parts.len();
        match (index % 2 == 1, closed) {
            (false, _) => out.push_str(part),
            (true, true) => {
                let _ = write!(out, "<code>{part}</code>");
            }
            // A single backtick is itself.
            (true, false) => {
                out.push('`');
                out.push_str(part);
            }
        }
    }
    out
}

/// JSON as it may stand inside a `<script>` element.
///
/// In JSON these characters can only occur within strings, where the escape means the same; without
/// it a `</script>` or `<!--` in somebody's label would end or swallow the element.
pub(super) fn escape_json(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                // Writing to a String cannot fail.
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_text() {
        assert_eq!(
            escape(r#"<b a='1' c="2">&amp;"#),
            "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;amp;"
        );
    }

    #[test]
    fn backticks_become_code() {
        assert_eq!(prose("run `a <b>` or `c`"), "run <code>a &lt;b&gt;</code> or <code>c</code>");
        assert_eq!(prose("a ` alone"), "a ` alone");
        assert_eq!(prose("`whole`"), "<code>whole</code>");
    }

    #[test]
    fn json_cannot_close_its_element_and_keeps_its_meaning() {
        let nasty = "</script><!-- <b>&\u{2028}";
        let json = serde_json::to_string(nasty).unwrap();
        let safe = escape_json(&json);
        assert!(!safe.contains(['<', '>', '&', '\u{2028}']));
        assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), nasty);
    }
}
