//! The page's server: for this machine alone, and for nothing but the page and the models that were
//! named.

use super::begin::Begin;
use super::site::{FILES, PAGE, START};
use crate::interrupt;
use crate::lab_args::LabPageArgs;
use crate::report::{self, Failure};
use axum::Router;
use axum::body::Bytes;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use std::net::Ipv4Addr;
use std::sync::Arc;
use tokio::net::TcpListener;

/// The policy of the page: scripts and styles of this server, WebAssembly, no network besides.
/// Pages may frame it.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; worker-src 'self'; \
    connect-src 'self'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'";

/// The page and the models that are served.
struct Site {
    page: Bytes,
    models: Vec<Bytes>,
    /// Hosts that are answered, as requests name them.
    hosts: [String; 2],
}

/// Serves until Ctrl-C; gives the exit code.
pub(super) fn serve(args: &LabPageArgs, begin: Begin) -> Result<u8, Failure> {
    let told = |e: std::io::Error| Failure::other(format!("port {}: {e}", args.port));
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_io().build().map_err(told)?;
    runtime.block_on(async {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).await.map_err(told)?;
        let port = listener.local_addr().map_err(told)?.port();
        let url = format!("http://127.0.0.1:{port}/");
        report::print(format!("{url}\n").as_bytes())?;
        if !args.no_open && open::that_detached(&url).is_err() {
            report::line("hint: no browser was found; open the address above in one");
        }

        let page = PAGE.replace(START, &begin.start(|number| Some(format!("models/{number}"))));
        let models = begin.files.into_iter().map(|file| file.bytes.into()).collect();
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
        let site = Arc::new(Site { page: page.into(), models, hosts });
        let router = Router::new().fallback(answer).with_state(Arc::clone(&site));
        let router = router.layer(middleware::from_fn_with_state(site, guard));
        interrupt::watch();
        axum::serve(listener, router).await.map_err(told)?;
        Ok(0)
    })
}

/// Refuses requests that name another host, as pages of others could send; adds the headers of
/// every answer.
async fn guard(State(site): State<Arc<Site>>, request: Request, next: Next) -> Response {
    let host = request.headers().get(header::HOST).and_then(|host| host.to_str().ok());
    let is_known =
        host.is_some_and(|host| site.hosts.iter().any(|known| known.eq_ignore_ascii_case(host)));
    let mut response = match is_known {
        true => next.run(request).await,
        false => {
            (StatusCode::FORBIDDEN, "this server answers its own machine alone\n").into_response()
        }
    };
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    response
}

/// The page, a file of it, or a model by its number.
async fn answer(State(site): State<Arc<Site>>, request: Request) -> Response {
    if !matches!(*request.method(), Method::GET | Method::HEAD) {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    let path = request.uri().path();
    if path == "/" || path == "/index.html" {
        return typed("text/html; charset=utf-8", site.page.clone());
    }
    if let Some(file) = FILES.iter().find(|file| path.strip_prefix('/') == Some(file.name)) {
        return typed(file.media_type, Bytes::from_static(file.bytes));
    }
    let number = path.strip_prefix("/models/").and_then(|number| number.parse::<usize>().ok());
    match number.and_then(|number| site.models.get(number)) {
        Some(model) => typed("application/octet-stream", model.clone()),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

fn typed(media_type: &'static str, bytes: Bytes) -> Response {
    let mut headers = HeaderMap::new();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
    (headers, bytes).into_response()
}
