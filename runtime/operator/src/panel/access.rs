//! Who may look, and who may press buttons.
//!
//! On the loopback everybody on this computer may look; to press a button a browser shows a token that only the console
//! has printed. On any other address the token must be configured, and nothing at all is shown without it.

use std::fs::File;
use std::io::Read;
use std::net::SocketAddr;

/// A configured token is at least this long.
const TOKEN_LENGTH_MIN: usize = 16;
/// Bytes of a token that we make.
const TOKEN_BYTES: usize = 16;

/// Where the panel listens, and its token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Access {
    /// The address.
    pub address: SocketAddr,
    /// The token.
    pub token: String,
}

/// Why the panel is not opened.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    /// Open to the network without a token.
    #[error(
        "--panel {0}: other computers can reach this address; set a token of {TOKEN_LENGTH_MIN} characters or more in \
         the environment variable FLOORGUARD_PANEL_TOKEN, or use 127.0.0.1"
    )]
    NeedsToken(SocketAddr),
    /// The token can be guessed.
    #[error(
        "FLOORGUARD_PANEL_TOKEN: give {TOKEN_LENGTH_MIN} characters or more, letters, digits, - and _ only"
    )]
    WeakToken,
    /// The system has no randomness.
    #[error("no token can be made: {0}")]
    Random(std::io::Error),
}

impl Access {
    /// For an address, with the configured token if there is one.
    ///
    /// # Errors
    /// [`AccessError`].
    pub fn new(address: SocketAddr, configured: Option<String>) -> Result<Self, AccessError> {
        let token = match configured {
            Some(token) if is_strong(&token) => token,
            Some(_) => return Err(AccessError::WeakToken),
            None if address.ip().is_loopback() => random_token().map_err(AccessError::Random)?,
            None => return Err(AccessError::NeedsToken(address)),
        };
        Ok(Self { address, token })
    }

    /// Whether this is the token. Takes as long for a nearly right one as for a wrong one.
    #[must_use]
    pub fn is_token(&self, shown: &str) -> bool {
        let (ours, theirs) = (self.token.as_bytes(), shown.as_bytes());
        let same_length = ours.len() == theirs.len();
        let difference = ours.iter().zip(theirs.iter().cycle()).fold(0, |all, (a, b)| all | (a ^ b));
        same_length && difference == 0
    }

    /// Whether looking is free.
    #[must_use]
    pub fn is_open_to_lookers(&self) -> bool {
        self.address.ip().is_loopback()
    }

    /// Whether a request was meant for this panel. A page of somebody else that has its own name point to this computer
    /// must not reach it.
    #[must_use]
    pub fn is_host(&self, host: &str) -> bool {
        if !self.is_open_to_lookers() {
            return true;
        }
        let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
        ["127.0.0.1", "localhost", "[::1]"].contains(&name)
    }
}

fn is_strong(token: &str) -> bool {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || letter == '-' || letter == '_';
    token.len() >= TOKEN_LENGTH_MIN && token.chars().all(plain)
}

fn random_token() -> std::io::Result<String> {
    let mut bytes = [0; TOKEN_BYTES];
    File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> SocketAddr {
        text.parse().unwrap()
    }

    #[test]
    fn network_needs_token_loopback_gets_one() {
        assert!(matches!(Access::new(address("0.0.0.0:80"), None), Err(AccessError::NeedsToken(_))));
        let weak = Access::new(address("0.0.0.0:80"), Some("secret".to_owned()));
        assert!(matches!(weak, Err(AccessError::WeakToken)));
        let access = Access::new(address("127.0.0.1:80"), None).unwrap();
        assert_eq!(access.token.len(), 2 * TOKEN_BYTES);
        assert_ne!(access, Access::new(address("127.0.0.1:80"), None).unwrap());
    }

    #[test]
    fn only_the_whole_token_opens() {
        let access = Access::new(address("10.0.0.1:80"), Some("abcdefghijklmnop".to_owned())).unwrap();
        assert!(access.is_token("abcdefghijklmnop"));
        for wrong in ["", "abcdefghijklmno", "abcdefghijklmnoq", "abcdefghijklmnopp"] {
            assert!(!access.is_token(wrong), "{wrong}");
        }
    }

    #[test]
    fn a_foreign_name_for_this_computer_is_refused() {
        let access = Access::new(address("127.0.0.1:8080"), None).unwrap();
        assert!(access.is_host("127.0.0.1:8080") && access.is_host("localhost:8080"));
        assert!(!access.is_host("evil.example:8080") && !access.is_host(""));
    }
}
