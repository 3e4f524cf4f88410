//! Connections: how many, and how long they may take.

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service as _, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use socket2::SockRef;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

use crate::guard::{ArrivedAt, Peer};

/// Connections at the same time; further ones wait.
pub(crate) const MOST_CONNECTIONS: usize = 512;
/// How long the head of a request may take, and a connection may be idle.
const HEAD_WITHIN: Duration = Duration::from_secs(10);
const MOST_HEADERS: usize = 64;
const MOST_HEAD_BYTES: usize = 32 << 10;
/// What waits in the kernel to be sent to a slow client: some records.
const UNSENT_BYTES: u32 = 16 << 10;
/// A client that takes nothing for so long, or does not answer, is gone.
const TAKES_WITHIN: Duration = Duration::from_secs(20);
/// After too many open files.
const PAUSE: Duration = Duration::from_millis(100);

/// Serves until the returned future is dropped.
pub(crate) async fn serve(listener: TcpListener, router: Router) {
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok(place) = Arc::clone(&places).acquire_owned().await else {
            return;
        };
        match listener.accept().await {
            Ok((stream, peer)) => {
                let router = router.clone();
                tokio::spawn(async move {
                    connection(stream, Peer(peer.ip()), router).await;
                    drop(place);
                });
            }
            Err(_) => tokio::time::sleep(PAUSE).await,
        }
    }
}

async fn connection(stream: TcpStream, peer: Peer, router: Router) {
    let Ok(at) = stream.local_addr() else {
        return;
    };
    // Without them it is served all the same.
    let _ = stream.set_nodelay(true);
    let _ = SockRef::from(&stream).set_tcp_notsent_lowat(UNSENT_BYTES);
    let _ = SockRef::from(&stream).set_tcp_user_timeout(Some(TAKES_WITHIN));
    let router = TowerToHyperService::new(router);
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(ArrivedAt(at));
        request.extensions_mut().insert(peer);
        router.call(request)
    });
    // What a client has done wrong, or that it has left, concerns nobody else.
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_WITHIN)
        .max_headers(MOST_HEADERS)
        .max_buf_size(MOST_HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), service)
        .with_upgrades()
        .await;
}
