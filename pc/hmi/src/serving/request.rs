//! The request of a viewer: the head of HTTP, with the token.

use super::token::Token;
use crate::sockets::is_wait;
use std::io::Read;
use std::time::Instant;
use tungstenite::handshake::derive_accept_key;

/// Largest head \[bytes\].
const LARGEST: usize = 8192;
/// Headers at most.
const HEADERS: usize = 64;

/// What is asked for.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Request {
    /// Path, without the query.
    pub path: String,
    /// What the connection becomes a WebSocket with.
    pub accept_key: Option<String>,
    /// It has shown the token.
    pub is_allowed: bool,
    /// What came after the head.
    pub rest: Vec<u8>,
}

/// Reads a request, to be whole by `end`; `None` of what is none.
pub(super) fn read(stream: &mut impl Read, token: &Token, end: Instant) -> Option<Request> {
    let mut head = Vec::new();
    let mut some = [0; 1024];
    loop {
        match stream.read(&mut some) {
            Ok(0) => return None,
            Ok(count) => head.extend_from_slice(&some[..count]),
            Err(error) if is_wait(&error) => {}
            Err(_) => return None,
        }
        match parsed(&head, token) {
            Parsed::Whole(request) => return Some(request),
            Parsed::Wrong => return None,
            Parsed::Part if head.len() > LARGEST || Instant::now() > end => return None,
            Parsed::Part => {}
        }
    }
}

enum Parsed {
    Whole(Request),
    Part,
    Wrong,
}

fn parsed(head: &[u8], token: &Token) -> Parsed {
    let mut headers = [httparse::EMPTY_HEADER; HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let length = match request.parse(head) {
        Ok(httparse::Status::Complete(length)) => length,
        Ok(httparse::Status::Partial) => return Parsed::Part,
        Err(_) => return Parsed::Wrong,
    };
    let target = request.path.unwrap_or_default();
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let header = |name: &str| {
        let mut all = request.headers.iter();
        let value = all.find(|header| header.name.eq_ignore_ascii_case(name))?.value;
        str::from_utf8(value).ok()
    };
    let asked = query.split('&').find_map(|pair| pair.strip_prefix("token="));
    let borne = header("Authorization").and_then(|value| value.strip_prefix("Bearer "));
    let is_upgrade = header("Upgrade").is_some_and(|value| value.eq_ignore_ascii_case("websocket"))
        && header("Sec-WebSocket-Version") == Some("13");
    let key = header("Sec-WebSocket-Key").filter(|_| is_upgrade);
    if request.method != Some("GET") {
        return Parsed::Wrong;
    }
    Parsed::Whole(Request {
        path: path.to_owned(),
        accept_key: key.map(|key| derive_accept_key(key.as_bytes())),
        is_allowed: borne.or(asked).is_some_and(|told| token.is(told)),
        rest: head[length..].to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn request(head: &str, token: &Token) -> Option<Request> {
        read(
            &mut head.as_bytes(),
            token,
            Instant::now() + Duration::from_secs(60),
        )
    }

    #[test]
    fn the_token_is_taken_from_the_header_or_the_query_and_from_nowhere_else() {
        let token = Token::random().unwrap();
        let told = token.text();
        let allowed = |head: &str| request(head, &token).map(|request| request.is_allowed);
        for (head, expected) in [
            (
                format!("GET / HTTP/1.1\r\nAuthorization: Bearer {told}\r\n\r\n"),
                true,
            ),
            (format!("GET /?a=b&token={told} HTTP/1.1\r\n\r\n"), true),
            (format!("GET /{told} HTTP/1.1\r\n\r\n"), false),
            (format!("GET /?token={told}0 HTTP/1.1\r\n\r\n"), false),
            (
                format!("GET /?token={told} HTTP/1.1\r\nAuthorization: Bearer x\r\n\r\n"),
                false,
            ),
            (format!("GET / HTTP/1.1\r\nCookie: token={told}\r\n\r\n"), false),
            ("GET / HTTP/1.1\r\n\r\n".to_owned(), false),
        ] {
            assert_eq!(allowed(&head), Some(expected), "{head}");
        }
        assert_eq!(allowed(&format!("POST /?token={told} HTTP/1.1\r\n\r\n")), None);
    }

    #[test]
    fn what_is_no_request_or_does_not_end_is_given_up() {
        let token = Token::random().unwrap();
        assert_eq!(request("\u{16}\u{3}\u{1}", &token), None);
        assert_eq!(request("GET / HTTP/1.1\r\n", &token), None);
        let endless = format!("GET / HTTP/1.1\r\n{}", "A: b\r\n".repeat(4000));
        assert_eq!(request(&endless, &token), None);
    }
}
