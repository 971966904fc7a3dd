//! Who may look, and who may press buttons.
//!
//! On the loopback everybody on this computer may look; to press a button a browser shows a token that only the console
//! has printed. On any other address tokens must be configured, and nothing at all is shown without one.

use std::fs::File;
use std::io::Read;
use std::net::SocketAddr;

use serde::Serialize;

/// A configured token is at least this long.
const TOKEN_LENGTH_MIN: usize = 16;
/// Bytes of a token that we make.
const TOKEN_BYTES: usize = 16;

/// What a person may do at the panel; each may do what those before may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Look.
    Viewer,
    /// Press the buttons, order missions, say where the robot is, acknowledge alerts.
    Operator,
    /// Draw areas.
    Technician,
}

/// The configured tokens.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tokens {
    /// Who shows it may look.
    pub viewer: Option<String>,
    /// Who shows it operates the robot. Without a token for technicians it is theirs, too.
    pub operator: Option<String>,
    /// Who shows it may draw areas.
    pub technician: Option<String>,
}

/// Where the panel listens, and its tokens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Access {
    /// The address.
    pub address: SocketAddr,
    /// The token that the console shows.
    pub token: String,
    others: Vec<(Role, String)>,
    role: Role,
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
    /// A token can be guessed.
    #[error(
        "FLOORGUARD_PANEL_TOKEN, _VIEWER_TOKEN and _TECHNICIAN_TOKEN: give {TOKEN_LENGTH_MIN} characters or more, \
         letters, digits, - and _ only"
    )]
    WeakToken,
    /// Two roles have one token.
    #[error("the tokens for viewers, operators and technicians must differ")]
    SameToken,
    /// The system has no randomness.
    #[error("no token can be made: {0}")]
    Random(std::io::Error),
}

impl Access {
    /// For an address, with the configured tokens if there are any.
    ///
    /// # Errors
    /// [`AccessError`].
    pub fn new(address: SocketAddr, configured: Tokens) -> Result<Self, AccessError> {
        let token = match configured.operator {
            Some(token) => token,
            None if address.ip().is_loopback() => random_token().map_err(AccessError::Random)?,
            None => return Err(AccessError::NeedsToken(address)),
        };
        let role = if configured.technician.is_some() { Role::Operator } else { Role::Technician };
        let others = [(Role::Viewer, configured.viewer), (Role::Technician, configured.technician)];
        let others: Vec<_> = others.into_iter().filter_map(|(role, token)| Some((role, token?))).collect();
        let all: Vec<&String> = others.iter().map(|(_, token)| token).chain([&token]).collect();
        if !all.iter().all(|token| is_strong(token)) {
            return Err(AccessError::WeakToken);
        }
        if all.iter().enumerate().any(|(index, token)| all.iter().take(index).any(|other| other == token)) {
            return Err(AccessError::SameToken);
        }
        Ok(Self { address, token, others, role })
    }

    /// The role of who shows this; `None`: not even looking. Takes as long for a nearly right token as for a wrong one.
    #[must_use]
    pub fn role(&self, shown: &str) -> Option<Role> {
        let own = [(self.role, &self.token)];
        let others = self.others.iter().map(|(role, token)| (*role, token));
        let free = self.address.ip().is_loopback().then_some(Role::Viewer);
        own.into_iter().chain(others).fold(free, |found, (role, token)| {
            if is_same(token, shown) { Some(found.map_or(role, |found| found.max(role))) } else { found }
        })
    }

    /// The token of viewers, where one is configured.
    #[must_use]
    pub fn viewer_token(&self) -> Option<String> {
        self.others.iter().find(|(role, _)| *role == Role::Viewer).map(|(_, token)| token.clone())
    }

    /// Whether a request was meant for this panel. A page of somebody else that has its own name point to this computer
    /// must not reach it.
    #[must_use]
    pub fn is_host(&self, host: &str) -> bool {
        if !self.address.ip().is_loopback() {
            return true;
        }
        let name = host.rsplit_once(':').map_or(host, |(name, _)| name);
        ["127.0.0.1", "localhost", "[::1]"].contains(&name)
    }
}

fn is_same(ours: &str, theirs: &str) -> bool {
    let (ours, theirs) = (ours.as_bytes(), theirs.as_bytes());
    let same_length = ours.len() == theirs.len();
    let difference = ours.iter().zip(theirs.iter().cycle()).fold(0, |all, (a, b)| all | (a ^ b));
    same_length && difference == 0
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

    const OPERATOR: &str = "abcdefghijklmnop";

    fn address(text: &str) -> SocketAddr {
        text.parse().unwrap()
    }

    fn tokens(viewer: Option<&str>, operator: Option<&str>, technician: Option<&str>) -> Tokens {
        let owned = |token: Option<&str>| token.map(str::to_owned);
        Tokens { viewer: owned(viewer), operator: owned(operator), technician: owned(technician) }
    }

    #[test]
    fn network_needs_token_loopback_gets_one() {
        let network = address("0.0.0.0:80");
        assert!(matches!(Access::new(network, Tokens::default()), Err(AccessError::NeedsToken(_))));
        let weak = Access::new(network, tokens(None, Some("secret"), None));
        assert!(matches!(weak, Err(AccessError::WeakToken)));
        let same = Access::new(network, tokens(Some(OPERATOR), Some(OPERATOR), None));
        assert!(matches!(same, Err(AccessError::SameToken)));
        let access = Access::new(address("127.0.0.1:80"), Tokens::default()).unwrap();
        assert_eq!(access.token.len(), 2 * TOKEN_BYTES);
        assert_ne!(access, Access::new(address("127.0.0.1:80"), Tokens::default()).unwrap());
        assert_eq!(
            (access.role(""), access.role(&access.token)),
            (Some(Role::Viewer), Some(Role::Technician))
        );
    }

    /// Each token opens what its role may do, and nothing more.
    #[test]
    fn only_the_whole_token_opens() {
        let (viewer, technician) = ("viewer-viewer-viewer", "tech-tech-tech-tech");
        let configured = tokens(Some(viewer), Some(OPERATOR), Some(technician));
        let access = Access::new(address("10.0.0.1:80"), configured).unwrap();
        let roles = [viewer, OPERATOR, technician].map(|token| access.role(token));
        assert_eq!(roles, [Some(Role::Viewer), Some(Role::Operator), Some(Role::Technician)]);
        for wrong in ["", "abcdefghijklmno", "abcdefghijklmnoq", "abcdefghijklmnopp"] {
            assert_eq!(access.role(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_foreign_name_for_this_computer_is_refused() {
        let access = Access::new(address("127.0.0.1:8080"), Tokens::default()).unwrap();
        assert!(access.is_host("127.0.0.1:8080") && access.is_host("localhost:8080"));
        assert!(!access.is_host("evil.example:8080") && !access.is_host(""));
    }
}
