//! `#[needs(...)]` above `#[test]`: a test that cannot run on this machine is reported as ignored,
//! with the reason, never as passed.
//!
//! ```text
//! #[needs(rclpy, namespace)]
//! #[test]
//! fn stock_tools_hear_the_driver() { ... }
//! ```
//!
//! What can be needed is told by `machine::Need`.

use machine::Need;
use proc_macro::{TokenStream, TokenTree};
use strum::VariantArray;

/// Has the test beneath ignored where this machine lacks something that it needs.
#[proc_macro_attribute]
pub fn needs(list: TokenStream, test: TokenStream) -> TokenStream {
    match missing(&list.to_string(), &test) {
        Ok(None) => test,
        Ok(Some(need)) => {
            [tokens(&format!("#[ignore = {:?}]", need.reason())), test].into_iter().collect()
        }
        Err(complaint) => tokens(&format!("compile_error!({complaint:?});")),
    }
}

fn tokens(code: &str) -> TokenStream {
    code.parse().unwrap_or_default()
}

/// The first of the list that this machine lacks.
fn missing(list: &str, test: &TokenStream) -> Result<Option<Need>, String> {
    let mut first = None;
    for name in list.split(',').map(str::trim).filter(|name| !name.is_empty()) {
        let need: Need = name.parse().map_err(|_| {
            let known: Vec<String> = Need::VARIANTS.iter().map(ToString::to_string).collect();
            format!("nobody knows the need `{name}`; expected some of: {}", known.join(", "))
        })?;
        let has = env!("MACHINE_HAS").split(',').any(|found| found == name);
        first = first.or((!has).then_some(need));
    }
    if !is_a_test(test) {
        return Err("`#[needs(...)]` stands above `#[test]`".to_owned());
    }
    Ok(first)
}

/// Whether `#[test]` is yet to come: after it, `#[ignore]` would not be heard.
fn is_a_test(item: &TokenStream) -> bool {
    item.clone().into_iter().any(
        |token| matches!(&token, TokenTree::Group(group) if group.stream().to_string() == "test"),
    )
}
