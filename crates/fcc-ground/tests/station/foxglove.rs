//! The newest records as Foxglove receives them, by the specification of its protocol.

use std::collections::BTreeMap;
use std::time::Duration;

use fcc_telemetry::FlightRecord;
use fcc_telemetry::schema::protobuf::decode;
use futures_util::{SinkExt as _, StreamExt as _};
use serde_json::{Value, json};
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::tungstenite::http::HeaderValue;

use crate::attacks::UPGRADE;
use crate::common::{Daemon, Ground, wait_for};

#[test]
fn a_client_gets_the_topics_that_it_subscribes_to() {
    let ground = Ground::with(&["--foxglove"]);
    let daemon = Daemon::start("foxglove");
    wait_for(&ground, &daemon);
    let token = ground.running.token.as_str();
    let path = format!("/foxglove/{}?token={token}", daemon.instance);
    ground.runtime.block_on(async {
        let address = format!("ws://{}{path}", ground.address());
        let mut request = address.into_client_request().unwrap();
        let headers = request.headers_mut();
        let protocols = HeaderValue::from_static("foxglove.sdk.v1, foxglove.websocket.v1");
        headers.insert("sec-websocket-protocol", protocols);
        // Its own page is of another site.
        let origin = HeaderValue::from_static("https://app.foxglove.dev");
        headers.insert("origin", origin);
        let (mut socket, answer) = connect_async(request).await.unwrap();
        assert_eq!(
            answer.headers()["sec-websocket-protocol"],
            "foxglove.sdk.v1"
        );
        let mut next = async || {
            let next = tokio::time::timeout(Duration::from_secs(10), socket.next()).await;
            next.expect("nothing came").unwrap().unwrap()
        };
        let json = |message: &Message| -> Value {
            serde_json::from_str(message.to_text().unwrap()).unwrap()
        };
        assert_eq!(json(&next().await)["op"], "serverInfo");
        let advertised = json(&next().await);
        assert_eq!(advertised["op"], "advertise");
        let channels = advertised["channels"].as_array().unwrap();
        let id_of: BTreeMap<_, _> = channels
            .iter()
            .map(|channel| (channel["topic"].as_str().unwrap(), &channel["id"]))
            .collect();
        let subscribe = json!({ "op": "subscribe", "subscriptions": [
            { "id": 70, "channelId": id_of["/fcc/record"] },
            { "id": 71, "channelId": id_of["/fcc/log"] },
            { "id": 72, "channelId": 1_000 },
        ]});
        for asked in [json!({ "op": "later versions ask for more" }), subscribe] {
            let asked = Message::text(asked.to_string());
            socket.send(asked).await.unwrap();
        }
        let mut ticks = Vec::new();
        while ticks.len() < 20 {
            let message = tokio::time::timeout(Duration::from_secs(10), socket.next()).await;
            let Message::Binary(bytes) = message.unwrap().unwrap().unwrap() else {
                continue;
            };
            let (head, message) = bytes.split_at(13);
            assert_eq!(head[0], 1);
            assert_eq!(head[1..5], 70_u32.to_le_bytes());
            let record: FlightRecord = decode(message).unwrap();
            let unix_ns = u64::from_le_bytes(head[5..].try_into().unwrap());
            ticks.push((record.tick.number, unix_ns));
        }
        for two in ticks.windows(2) {
            let later = two[1].0 - two[0].0;
            assert_eq!(two[1].1 - two[0].1, later * 25_000_000);
        }
        let unsubscribe = json!({ "op": "unsubscribe", "subscriptionIds": [70] });
        socket
            .send(Message::text(unsubscribe.to_string()))
            .await
            .unwrap();
        // What was on the way.
        tokio::time::sleep(Duration::from_millis(300)).await;
        while let Ok(Some(_)) = tokio::time::timeout(Duration::from_millis(10), socket.next()).await
        {
        }
        let more = tokio::time::timeout(Duration::from_millis(500), async {
            loop {
                if let Message::Binary(_) = socket.next().await.unwrap().unwrap() {
                    break;
                }
            }
        });
        assert!(more.await.is_err(), "a record came");
    });
}

#[test]
fn without_the_option_or_the_token_there_is_no_stream_for_foxglove() {
    let daemon = Daemon::start("no-foxglove");
    let statuses = |ground: &Ground, token: &str| {
        wait_for(ground, &daemon);
        let what = format!("GET /foxglove/{}?token={token}", daemon.instance);
        ground.send(&what, &UPGRADE, "").status
    };
    let without = Ground::new();
    assert_eq!(statuses(&without, without.running.token.as_str()), 404);
    let with = Ground::with(&["--foxglove"]);
    assert_eq!(statuses(&with, ""), 401);
    assert_eq!(statuses(&with, without.running.token.as_str()), 401);
    let what = format!("GET /foxglove/{}", daemon.instance);
    assert_eq!(with.send(&what, &UPGRADE, "").status, 401);
    // A name that was rebound is refused before.
    let token = with.running.token.as_str();
    let what = format!(
        "GET /foxglove/{}?token={token} HTTP/1.1\r\n",
        daemon.instance
    );
    let head = [
        what.as_str(),
        "Host: evil.example\r\n",
        &UPGRADE.join("\r\n"),
        "\r\n\r\n",
    ];
    assert_eq!(with.raw(head.concat().as_bytes()).status, 403);
}
