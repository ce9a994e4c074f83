//! A session: who a client is, and what its requests do. Source: OPC 10000-4.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plcc_abi::services::Right;

use super::Server;
use super::attributes::{self, Change, Question, Wanted, change};
use super::channel::Channel;
use super::code::{Id, NodeId, Reader, Writer, now};
use super::crypto::{NONCE_BYTES, Policy, random};
use super::identity;
use super::range::Range;
use super::status::{self, Status};
use super::subscription::{Published, Subscriptions};
use super::view::{self, Continuations, check_count};
use crate::limits::{OPCUA_REQUEST_MAX, OPCUA_RESPONSE_MAX, OPCUA_SESSION_TIME};

/// Numbers of encodings: of requests; that of a response is three more.
const FIND_SERVERS: u32 = 422;
const GET_ENDPOINTS: u32 = 428;
const CREATE_SESSION: u32 = 461;
const ACTIVATE_SESSION: u32 = 467;
const CLOSE_SESSION: u32 = 473;
const BROWSE: u32 = 527;
const BROWSE_NEXT: u32 = 533;
const TRANSLATE: u32 = 554;
const REGISTER_NODES: u32 = 560;
const UNREGISTER_NODES: u32 = 566;
const READ: u32 = 631;
const WRITE: u32 = 673;
const CREATE_ITEMS: u32 = 751;
const MODIFY_ITEMS: u32 = 763;
const SET_MODE: u32 = 769;
const DELETE_ITEMS: u32 = 781;
const CREATE_SUBSCRIPTION: u32 = 787;
const MODIFY_SUBSCRIPTION: u32 = 793;
const SET_PUBLISHING: u32 = 799;
const PUBLISH: u32 = 826;
const REPUBLISH: u32 = 832;
const DELETE_SUBSCRIPTIONS: u32 = 847;
const SERVICE_FAULT: u32 = 397;

/// Sessions do not outlive a connection, which has one of them at most.
pub struct Session {
    token: [u8; 32],
    /// What the client has to sign.
    nonce: [u8; NONCE_BYTES],
    /// What the client may do; `None`: it has not signed in.
    right: Option<Right>,
    time: Duration,
    used: Instant,
    most: usize,
    subscriptions: Subscriptions,
    continuations: Continuations,
}

/// What is said to a client, with the numbers of the requests.
pub struct Response {
    pub request: u32,
    pub body: Vec<u8>,
}

/// Head of a request.
#[derive(Clone)]
struct Head {
    token: NodeId,
    handle: u32,
}

/// Reads the head of a request: authentication, time, handle, diagnostics, audit entry, timeout, and what else there is.
fn head(reader: &mut Reader) -> Option<Head> {
    let token = reader.node()?;
    let _time = reader.i64()?;
    let handle = reader.u32()?;
    let _rest = (reader.u32()?, reader.text()?, reader.u32()?, reader.object()?);
    Some(Head { token, handle })
}

/// The handle of a request that opens a channel, what comes after its head.
pub fn opening_head<'a>(body: &'a [u8]) -> Option<(u32, u32, Reader<'a>)> {
    let mut reader = Reader(body);
    let service = reader.node()?.standard()?;
    let head = head(&mut reader)?;
    Some((service, head.handle, reader))
}

/// A response with its head.
pub fn response(service: u32, handle: u32, status: Status, body: &[u8]) -> Vec<u8> {
    let mut out = Writer::default();
    out.node(&NodeId::number(0, service));
    out.i64(now());
    out.u32(handle);
    out.u32(status);
    out.u8(0);
    out.null();
    out.object(0, &[]);
    out.0.extend(body);
    out.0
}

/// A response that says why there is none.
pub fn fault(handle: u32, status: Status) -> Vec<u8> {
    response(SERVICE_FAULT, handle, status, &[])
}

/// What has become of a request.
enum Done {
    /// The body of the response.
    Answer(Writer),
    /// The answer comes later.
    Later(Option<Published>),
    /// The session has ended.
    End,
}

/// How old may be what is known of the program for a request that asks the CPU for nothing. `None`: it does, or nodes do not matter.
pub fn age_max(body: &[u8]) -> Option<Duration> {
    match Reader(body).node().and_then(|node| node.standard()) {
        // A client that browses sends many.
        Some(BROWSE) => Some(Duration::from_millis(500)),
        Some(TRANSLATE | CREATE_ITEMS) => Some(Duration::ZERO),
        _ => None,
    }
}

/// Carries out a request. `None`: the CPU has ended, or has another program; then the request has done nothing.
pub async fn serve(
    server: &Arc<Server>,
    session: &mut Option<Session>,
    channel: &Channel,
    right: Right,
    (request, body): (u32, &[u8]),
) -> Option<Vec<Response>> {
    let mut reader = Reader(body);
    let one = |body: Vec<u8>| Some(vec![Response { request, body }]);
    let Some(service) = reader.node().and_then(|node| node.standard()) else {
        return one(fault(0, status::DECODING));
    };
    let Some(head) = head(&mut reader) else { return one(fault(0, status::DECODING)) };
    let most = session.as_ref().map_or(OPCUA_RESPONSE_MAX, |session| session.most);
    let done = match service {
        FIND_SERVERS | GET_ENDPOINTS => discover(server, service, &mut reader),
        CREATE_SESSION => create(server, session, channel, &mut reader),
        ACTIVATE_SESSION => activate(server, session, channel, right, &head, &mut reader).await,
        _ => match known(session, &head) {
            Ok(Known { session, right }) => {
                session.serve(server, right, service, (request, head.handle), &mut reader).await?
            }
            Err(status) => Err(status),
        },
    };
    match done {
        Ok(Done::Answer(out)) if out.0.len() > most => one(fault(head.handle, status::RESPONSE_TOO_LARGE)),
        Ok(Done::Answer(out)) => one(response(service + 3, head.handle, status::GOOD, &out.0)),
        Ok(Done::Later(published)) => Some(published.map(published_response).into_iter().collect()),
        Ok(Done::End) => {
            *session = None;
            one(response(service + 3, head.handle, status::GOOD, &[]))
        }
        Err(status) => one(fault(head.handle, status)),
    }
}

/// A session that a request belongs to.
struct Known<'a> {
    session: &'a mut Session,
    right: Right,
}

fn known<'a>(session: &'a mut Option<Session>, head: &Head) -> Result<Known<'a>, Status> {
    let session = session.as_mut().filter(|session| session.is_of(head)).ok_or(status::SESSION_INVALID)?;
    session.used = Instant::now();
    let right = session.right.ok_or(status::SESSION_NOT_ACTIVATED)?;
    Ok(Known { session, right })
}

fn published_response((request, handle, content): Published) -> Response {
    let body = match content {
        Ok(body) => response(PUBLISH + 3, handle, status::GOOD, &body),
        Err(status) => fault(handle, status),
    };
    Response { request, body }
}

fn discover(server: &Server, service: u32, reader: &mut Reader) -> Result<Done, Status> {
    let url = reader.text().ok_or(status::DECODING)?;
    let mut out = Writer::default();
    match service {
        FIND_SERVERS => identity::put_servers(server, &mut out, &url),
        _ => identity::put_endpoints(server, &mut out, &url),
    }
    Ok(Done::Answer(out))
}

/// Skips an ApplicationDescription.
fn application(reader: &mut Reader) -> Option<()> {
    let _names = (reader.text()?, reader.text()?, reader.localized()?, reader.u32()?, reader.text()?, reader.text()?);
    reader.list(Reader::text).map(|_| ())
}

fn create(
    server: &Server,
    session: &mut Option<Session>,
    channel: &Channel,
    reader: &mut Reader,
) -> Result<Done, Status> {
    let read = |reader: &mut Reader| {
        application(reader)?;
        let (_, url, _) = (reader.text()?, reader.text()?, reader.text()?);
        Some((url, reader.bytes()?.to_vec(), reader.bytes()?.to_vec(), reader.f64()?, reader.u32()?))
    };
    let (url, nonce, certificate, time, most) = read(reader).ok_or(status::DECODING)?;
    if channel.policy == Policy::None && !server.is_open {
        return Err(status::POLICY_REJECTED);
    }
    if session.is_some() {
        return Err(status::TOO_MANY_SESSIONS);
    }
    let mut signature = Vec::new();
    if let Some(client) = &channel.client {
        if !certificate.starts_with(&client.der) {
            return Err(status::CERTIFICATE_INVALID);
        }
        if nonce.len() < NONCE_BYTES {
            return Err(status::NONCE_INVALID);
        }
        let signed = [certificate, nonce].concat();
        signature = channel.policy.sign(&server.own.key, &signed).ok_or(status::INTERNAL)?;
    }
    let time = if time.is_finite() && time > 0.0 {
        Duration::from_secs_f64((time / 1000.0).min(1e6))
    } else {
        *OPCUA_SESSION_TIME.end()
    };
    let time = time.clamp(*OPCUA_SESSION_TIME.start(), *OPCUA_SESSION_TIME.end());
    let (token, nonce, id) = (random().ok_or(status::INTERNAL)?, random().ok_or(status::INTERNAL)?, random::<4>());
    let id = id.map(u32::from_le_bytes).ok_or(status::INTERNAL)?;
    let mut out = Writer::default();
    out.node(&NodeId::number(1, id));
    out.node(&NodeId { namespace: 1, id: Id::Bytes(token.to_vec()) });
    out.f64(time.as_secs_f64() * 1000.0);
    out.bytes(&nonce);
    out.bytes(&server.own.certificate);
    identity::put_endpoints(server, &mut out, &url);
    out.null();
    match channel.policy {
        Policy::None => {
            out.null();
            out.null();
        }
        policy => {
            out.text(policy.signature_uri());
            out.bytes(&signature);
        }
    }
    out.u32(OPCUA_REQUEST_MAX as u32);
    *session = Some(Session {
        token,
        nonce,
        right: None,
        time,
        used: Instant::now(),
        most: if most == 0 { OPCUA_RESPONSE_MAX } else { OPCUA_RESPONSE_MAX.min(most as usize) },
        subscriptions: Subscriptions::default(),
        continuations: Continuations::default(),
    });
    Ok(Done::Answer(out))
}

async fn activate(
    server: &Arc<Server>,
    session: &mut Option<Session>,
    channel: &Channel,
    right: Right,
    head: &Head,
    reader: &mut Reader<'_>,
) -> Result<Done, Status> {
    let session = session.as_mut().filter(|session| session.is_of(head)).ok_or(status::SESSION_INVALID)?;
    session.used = Instant::now();
    let read = |reader: &mut Reader| {
        let _algorithm = reader.text()?;
        let signature = reader.bytes()?.to_vec();
        reader.list(|reader| Some((reader.bytes()?.len(), reader.bytes()?.len())))?;
        reader.list(Reader::text)?;
        let (ty, body) = reader.object()?;
        Some((signature, ty, body.to_vec()))
    };
    let (signature, ty, token) = read(reader).ok_or(status::DECODING)?;
    if let Some(client) = &channel.client {
        let signed = [&server.own.certificate[..], &session.nonce].concat();
        if !channel.policy.is_signed(&client.key, &signed, &signature) {
            return Err(status::SIGNATURE_INVALID);
        }
    }
    // A nonce is used once.
    let nonce = std::mem::replace(&mut session.nonce, random().ok_or(status::INTERNAL)?);
    session.right = None;
    session.right = Some(identity::sign_in(server, (ty, &token), &nonce, right).await?);
    let mut out = Writer::default();
    out.bytes(&session.nonce);
    out.null();
    out.null();
    Ok(Done::Answer(out))
}

impl Session {
    fn is_of(&self, head: &Head) -> bool {
        matches!(&head.token.id, Id::Bytes(bytes) if *bytes == self.token) && head.token.namespace == 1
    }

    /// Somebody has signed in.
    pub fn is_active(&self) -> bool {
        self.right.is_some()
    }

    /// When there is something to do without a request.
    pub fn due(&self) -> Instant {
        let end = self.used + self.time;
        self.subscriptions.due().map_or(end, |due| due.min(end))
    }

    /// It has not been used for too long.
    pub fn is_over(&self) -> bool {
        self.used + self.time <= Instant::now()
    }

    /// After a change of the program.
    pub fn renew(&mut self, server: &Server) {
        // Places in the earlier nodes.
        self.continuations = Continuations::default();
        if let Some(right) = self.right {
            self.subscriptions.renew(server, right);
        }
    }

    /// Responses to publish requests. `None`: the CPU has ended, or has another program.
    pub async fn tick(&mut self, server: &Server) -> Option<Vec<Response>> {
        Some(self.subscriptions.tick(server).await?.into_iter().map(published_response).collect())
    }

    /// `None`: the CPU has ended.
    async fn serve(
        &mut self,
        server: &Server,
        right: Right,
        service: u32,
        (request, handle): (u32, u32),
        reader: &mut Reader<'_>,
    ) -> Option<Result<Done, Status>> {
        let mut out = Writer::default();
        let subscriptions = &mut self.subscriptions;
        let done = match service {
            READ => match questions(server, right, reader) {
                Ok((wanted, times)) => {
                    let values = attributes::read(server, wanted).await?;
                    out.list(&values, |out, value| out.data_value(value, times));
                    out.null();
                    Ok(())
                }
                Err(status) => Err(status),
            },
            WRITE => match changes(server, right, reader) {
                Ok(changes) => {
                    out.statuses(&attributes::write(server, changes).await?);
                    Ok(())
                }
                Err(status) => Err(status),
            },
            BROWSE => view::browse(server, &mut self.continuations, reader, &mut out),
            BROWSE_NEXT => view::browse_next(&mut self.continuations, reader, &mut out),
            TRANSLATE => view::translate(server, reader, &mut out),
            REGISTER_NODES => register(reader, &mut out),
            UNREGISTER_NODES => reader.list(Reader::node).map(|_| ()).ok_or(status::DECODING),
            CREATE_SUBSCRIPTION => subscriptions.create(reader, &mut out),
            MODIFY_SUBSCRIPTION => subscriptions.modify(reader, &mut out),
            SET_PUBLISHING => subscriptions.set_publishing(reader, &mut out),
            DELETE_SUBSCRIPTIONS => subscriptions.delete(reader, &mut out),
            CREATE_ITEMS => {
                let done = subscriptions.create_items(server, right, reader, &mut out);
                if subscriptions.has_new_events() {
                    let count = server.link.ask(|cpu| cpu.diagnostics.count()).await?;
                    subscriptions.begin_events(count);
                }
                done
            }
            MODIFY_ITEMS => subscriptions.modify_items(reader, &mut out),
            SET_MODE => subscriptions.set_mode(reader, &mut out),
            DELETE_ITEMS => subscriptions.delete_items(reader, &mut out),
            REPUBLISH => subscriptions.republish(reader, &mut out),
            PUBLISH => return Some(subscriptions.publish(request, handle, reader).map(Done::Later)),
            CLOSE_SESSION => return Some(Ok(Done::End)),
            _ => Err(status::SERVICE_UNSUPPORTED),
        };
        Some(done.map(|()| Done::Answer(out)))
    }
}

/// What a Read asks for, and which times.
fn questions(server: &Server, right: Right, reader: &mut Reader) -> Result<(Vec<Wanted>, u32), Status> {
    let read = |reader: &mut Reader| Some((reader.f64()?, reader.u32()?, reader.list(Question::read)?));
    // Values are of the next cycle, however old they may be.
    let (age, times, questions) = read(reader).ok_or(status::DECODING)?;
    check_count(questions.len())?;
    if age < 0.0 {
        return Err(status::MAX_AGE_INVALID);
    }
    if times > 3 {
        return Err(status::TIMESTAMPS_INVALID);
    }
    Ok((questions.iter().map(|question| question.wanted(server, right)).collect(), times))
}

/// What a Write asks for.
fn changes(server: &Server, right: Right, reader: &mut Reader) -> Result<Vec<Change>, Status> {
    let one = |reader: &mut Reader| Some((reader.node()?, reader.u32()?, reader.text()?, reader.data_value()?));
    let values = reader.list(one).ok_or(status::DECODING)?;
    check_count(values.len())?;
    let check =
        |(node, attribute, range, (value, status)): &(NodeId, u32, String, _)| match (Range::parse(range), *status) {
            (Ok(range), status::GOOD) => change(server, (node, *attribute), value, range.as_ref(), right),
            (Ok(_), _) => Change::Wrong(status::WRITE_NOT_SUPPORTED),
            (Err(status), _) => Change::Wrong(status),
        };
    Ok(values.iter().map(check).collect())
}

/// Nodes keep their ids: nothing is quicker.
fn register(reader: &mut Reader, out: &mut Writer) -> Result<(), Status> {
    let nodes = reader.list(Reader::node).ok_or(status::DECODING)?;
    check_count(nodes.len())?;
    out.list(&nodes, |out, node| out.node(node));
    Ok(())
}
