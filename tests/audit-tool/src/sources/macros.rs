//! What stands inside a macro: syntax gives only its words, so that its arguments are parsed where that goes.

use proc_macro2::{TokenStream, TokenTree};
use syn::Token;
use syn::parse::Parser as _;
use syn::punctuated::Punctuated;

/// The arguments, where all of them are expressions, as in `write!(f, "…", x)`; of `matches!` its value and its
/// condition.
pub fn arguments(invocation: &syn::Macro) -> Option<Vec<syn::Expr>> {
    if invocation.path.is_ident("matches") {
        let parsed = match_arguments.parse2(invocation.tokens.clone());
        return parsed.ok();
    }
    let parser = Punctuated::<syn::Expr, Token![,]>::parse_terminated;
    let parsed = parser.parse2(invocation.tokens.clone()).ok()?;
    Some(parsed.into_iter().collect())
}

fn match_arguments(input: syn::parse::ParseStream<'_>) -> syn::Result<Vec<syn::Expr>> {
    let mut found = vec![input.parse()?];
    input.parse::<Token![,]>()?;
    syn::Pat::parse_multi_with_leading_vert(input)?;
    if input.parse::<Option<Token![if]>>()?.is_some() {
        found.push(input.parse()?);
    }
    input.parse::<Option<Token![,]>>()?;
    Ok(found)
}

/// Every word between the parentheses of a macro, or of a rule that makes one, with its line.
pub fn words(tokens: &TokenStream) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for token in tokens.clone() {
        match token {
            TokenTree::Ident(word) => found.push((word.to_string(), word.span().start().line)),
            TokenTree::Group(group) => found.extend(words(&group.stream())),
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macro_arguments_are_parsed_at_any_depth() {
        let macro_of = |text: &str| syn::parse_str::<syn::Macro>(text).expect("a macro");
        assert_eq!(arguments(&macro_of("write!(f, \"{}\", x.y())")).map(|found| found.len()), Some(3));
        assert_eq!(arguments(&macro_of("matches!(x, 3.. | 1 if y)")).map(|found| found.len()), Some(2));
        assert!(arguments(&macro_of("m!(a => { loop {} })")).is_none());
        let found = words(&macro_of("m!(a => {\n loop {} })").tokens);
        assert_eq!(found, [("a".to_owned(), 1), ("loop".to_owned(), 2)]);
    }
}
