//! One connection: a file of the page, or the way to a socket.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;
use http_body_util::Full;
use hyper::body::Incoming;
use hyper::header::{
    ALLOW, CACHE_CONTROL, CONNECTION, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, HeaderName,
    HeaderValue, ORIGIN, REFERRER_POLICY, SEC_WEBSOCKET_ACCEPT, SEC_WEBSOCKET_KEY,
    SEC_WEBSOCKET_PROTOCOL, SEC_WEBSOCKET_VERSION, UPGRADE, X_CONTENT_TYPE_OPTIONS,
    X_FRAME_OPTIONS,
};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::TcpStream;
use tokio::sync::OwnedSemaphorePermit;
use tokio_tungstenite::tungstenite::handshake::derive_accept_key;

use crate::protocol::SPOKEN;
use crate::shared::Shared;
use crate::{Access, assets, client, files};

/// Time for the head of a request.
const HEAD: Duration = Duration::from_secs(5);
/// Time for a whole answer.
const ANSWER: Duration = Duration::from_secs(20);
/// Room for the head of a request \[bytes\].
const HEAD_BYTES: usize = 16 << 10;
/// What stands before a token among the names of protocols.
const TOKEN: &str = "token.";

type Answer = Response<Full<Bytes>>;

/// Serves one connection, which has one request.
pub(crate) async fn serve(stream: TcpStream, shared: Arc<Shared>, place: OwnedSemaphorePermit) {
    let place = Arc::new(place);
    let answer = service_fn(|request| {
        let (shared, place) = (Arc::clone(&shared), Arc::clone(&place));
        async move {
            let mut answer = answer(request, &shared, &place).await;
            if answer.status() != StatusCode::SWITCHING_PROTOCOLS {
                // One request, one answer.
                answer.headers_mut().insert(CONNECTION, HeaderValue::from_static("close"));
            }
            Ok::<_, Infallible>(answer)
        }
    });
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD)
        .max_buf_size(HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), answer)
        .with_upgrades();
    // Whatever went wrong: the connection is over.
    let _ = tokio::time::timeout(ANSWER, connection).await;
}

async fn answer(
    request: Request<Incoming>,
    shared: &Arc<Shared>,
    place: &Arc<OwnedSemaphorePermit>,
) -> Answer {
    if request.method() != Method::GET {
        let mut answer = refusal(StatusCode::METHOD_NOT_ALLOWED, "Only GET is answered here.");
        answer.headers_mut().insert(ALLOW, HeaderValue::from_static("GET"));
        return answer;
    }
    let host = text(&request, HOST).unwrap_or_default().to_owned();
    if !shared.origins.is_host(&host) {
        return refusal(
            StatusCode::MISDIRECTED_REQUEST,
            "This server is called by its address, as http://127.0.0.1:8765/, and by no other name.",
        );
    }
    if text(&request, UPGRADE).is_some_and(|name| name.eq_ignore_ascii_case("websocket")) {
        return upgrade(request, &host, shared, place);
    }
    match assets::find(request.uri().path()) {
        Some(asset) => {
            let mut answer = Response::new(Full::new(Bytes::from_static(asset.bytes)));
            answer.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(asset.kind));
            guarded(answer, &host)
        }
        None => match files::asked(request.uri().path(), shared) {
            Some((folder, name)) => file(shared, folder, name.to_owned(), &host).await,
            None => guarded(nothing(), &host),
        },
    }
}

fn nothing() -> Answer {
    refusal(StatusCode::NOT_FOUND, "There is nothing here.")
}

/// Shows a file, with an origin of its own.
async fn file(shared: &Arc<Shared>, folder: u32, name: String, host: &str) -> Answer {
    // Nobody closes it.
    let Ok(place) = Arc::clone(&shared.reading).acquire_owned().await else {
        return guarded(nothing(), host);
    };
    let steering = Arc::clone(&shared.steering);
    let read = tokio::task::spawn_blocking(move || {
        let shown = steering.file(folder, &name);
        drop(place);
        shown
    });
    let Ok(Some(shown)) = read.await else { return guarded(nothing(), host) };
    let mut answer = Response::new(Full::new(Bytes::from(shown.bytes)));
    answer.headers_mut().insert(CONTENT_TYPE, HeaderValue::from_static(shown.kind));
    let mut answer = guarded(answer, host);
    let policy = HeaderValue::from_static(files::POLICY);
    answer.headers_mut().insert(CONTENT_SECURITY_POLICY, policy);
    answer
}

/// Opens a socket, or says why not.
fn upgrade(
    mut request: Request<Incoming>,
    host: &str,
    shared: &Arc<Shared>,
    place: &Arc<OwnedSemaphorePermit>,
) -> Answer {
    if let Some(origin) = request.headers().get(ORIGIN)
        && !origin.to_str().is_ok_and(|origin| shared.origins.is_allowed(origin, host))
    {
        return refusal(
            StatusCode::FORBIDDEN,
            "Pages from elsewhere are not let in; --view-origin names those that are.",
        );
    }
    let asked = text(&request, SEC_WEBSOCKET_PROTOCOL).unwrap_or_default().to_owned();
    let asked = || asked.split(',').map(str::trim);
    let query = request.uri().query().unwrap_or_default();
    let word = asked()
        .find_map(|name| name.strip_prefix(TOKEN))
        .or_else(|| query.split('&').find_map(|pair| pair.strip_prefix("token=")))
        .unwrap_or_default();
    let access = match &shared.tokens {
        None => Some(Access::Full),
        Some(tokens) => tokens.access(word),
    };
    let Some(access) = access else {
        return refusal(
            StatusCode::UNAUTHORIZED,
            "The token is missing or wrong; the program printed it when it started.",
        );
    };
    let spoken = SPOKEN.iter().find(|spoken| asked().any(|name| name == **spoken));
    let key = text(&request, SEC_WEBSOCKET_KEY).filter(|key| key.len() == 24);
    let version = text(&request, SEC_WEBSOCKET_VERSION);
    let (Some(spoken), Some(key), Some("13")) = (spoken, key, version) else {
        return refusal(
            StatusCode::BAD_REQUEST,
            "WebSocket 13 with the protocol foxglove.websocket.v1 or foxglove.sdk.v1 is spoken here.",
        );
    };
    let Ok(viewer) = Arc::clone(&shared.viewers).try_acquire_owned() else {
        return refusal(StatusCode::SERVICE_UNAVAILABLE, "There are as many viewers as can be.");
    };
    let mut answer = Response::new(Full::default());
    *answer.status_mut() = StatusCode::SWITCHING_PROTOCOLS;
    let headers = answer.headers_mut();
    headers.insert(CONNECTION, HeaderValue::from_static("Upgrade"));
    headers.insert(UPGRADE, HeaderValue::from_static("websocket"));
    headers.insert(SEC_WEBSOCKET_PROTOCOL, HeaderValue::from_static(spoken));
    if let Ok(accept) = HeaderValue::from_str(&derive_accept_key(key.as_bytes())) {
        headers.insert(SEC_WEBSOCKET_ACCEPT, accept);
    }
    let (shared, place) = (Arc::clone(shared), Arc::clone(place));
    tokio::spawn(async move {
        if let Ok(upgraded) = hyper::upgrade::on(&mut request).await {
            client::serve(TokioIo::new(upgraded), &shared, access).await;
        }
        drop((viewer, place));
    });
    answer
}

fn text(request: &Request<Incoming>, name: HeaderName) -> Option<&str> {
    request.headers().get(name)?.to_str().ok()
}

fn refusal(status: StatusCode, why: &'static str) -> Answer {
    let mut answer = Response::new(Full::new(Bytes::from_static(why.as_bytes())));
    *answer.status_mut() = status;
    let kind = HeaderValue::from_static("text/plain; charset=utf-8");
    answer.headers_mut().insert(CONTENT_TYPE, kind);
    answer
}

/// With the headers that keep the page to itself.
fn guarded(mut answer: Answer, host: &str) -> Answer {
    // Browsers differ in whether 'self' means the page's socket too. The host was checked.
    let policy = format!(
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    let headers = answer.headers_mut();
    if let Ok(policy) = HeaderValue::from_str(&policy) {
        headers.insert(CONTENT_SECURITY_POLICY, policy);
    }
    for (name, value) in [
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
        (CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    answer
}
