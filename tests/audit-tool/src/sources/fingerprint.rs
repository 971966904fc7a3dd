//! Whether code is still the one that a record was made with.

use anyhow::Result;
use proc_macro2::{Group, TokenStream, TokenTree};

use super::files::{SourceFile, read_audited};
use crate::shell;

/// The fingerprint of the audited crates as they are now.
pub fn code_today() -> Result<String> {
    Ok(fingerprint(&read_audited(&shell::root())?))
}

/// A 64-bit fingerprint (FNV-1a) of what code does: their syntax without tests, remarks and layout. A record of a
/// long run keeps it, so that a reader sees whether the code has changed since.
pub fn fingerprint(files: &[SourceFile]) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for file in files {
        let tokens = without_docs(quote::ToTokens::to_token_stream(&file.syntax)).to_string();
        for byte in file.path.bytes().chain([0]).chain(tokens.bytes()).chain([0]) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    format!("{hash:016x}")
}

/// Remarks for readers are attributes of the syntax: they change nothing, and are left out.
pub fn without_docs(tokens: TokenStream) -> TokenStream {
    let is_doc =
        |group: &Group| group.stream().into_iter().next().is_some_and(|token| token.to_string() == "doc");
    let mut kept: Vec<TokenTree> = Vec::new();
    for token in tokens {
        match token {
            TokenTree::Group(group) if is_doc(&group) => {
                let sign = |token: &TokenTree| matches!(token.to_string().as_str(), "#" | "!");
                while kept.last().is_some_and(sign) {
                    kept.pop();
                }
            }
            TokenTree::Group(group) => {
                kept.push(Group::new(group.delimiter(), without_docs(group.stream())).into());
            }
            other => kept.push(other),
        }
    }
    kept.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sources::parse;

    #[test]
    fn the_fingerprint_is_of_what_the_code_does() {
        let of = |text: &str| {
            fingerprint(&[parse("core-nostd/types/src/a.rs", text.to_owned()).expect("it parses")])
        };
        let plain = of("fn f() -> u8 { 1 }");
        assert_eq!(
            plain,
            of(
                "//! Above.\n/// Says \"so\".\nfn f()\n -> u8 { 1 } // one\n#[cfg(test)]\nmod tests { fn g() {} }"
            )
        );
        assert_ne!(plain, of("fn f() -> u8 { 2 }"));
        assert_ne!(plain, of("fn g() -> u8 { 1 }"));
    }
}
