//! What clients may use up: connections, sizes, times. All limits of all services are here.

use std::time::Duration;

/// Connections of one service at once, and those of one computer among them.
pub const CONNECTIONS_MAX: usize = 32;
pub const CONNECTIONS_OF_ONE_MAX: usize = 8;
/// Those of the page: a browser opens six at once, and people behind one address open it at the same time.
pub const PAGE_CONNECTIONS_MAX: usize = 96;
pub const PAGE_CONNECTIONS_OF_ONE_MAX: usize = 48;

/// How long an S7 client may take to ask for a connection, and to agree on the length of PDUs.
pub const CONNECT_TIME: Duration = Duration::from_secs(5);
pub const SETUP_TIME: Duration = Duration::from_secs(10);
/// How long any client may take to complete a frame that has begun, and to take an answer.
pub const FRAME_TIME: Duration = Duration::from_secs(5);
pub const ANSWER_TIME: Duration = Duration::from_secs(5);

/// Requests that wait for the CPU; a client with another one waits until there is room.
pub const QUEUE_MAX: usize = 64;

/// Cyclic jobs of an S7 connection, and variables of one.
pub const SUBSCRIPTIONS_MAX: usize = 16;
pub const SUBSCRIBED_ITEMS_MAX: usize = 20;
/// S7 jobs of a connection that may wait for their answers.
pub const PARALLEL_JOBS_MAX: u16 = 8;
/// Pieces of an S7 PDU, and those of them without a byte.
pub const PIECES_MAX: usize = 64;
pub const EMPTY_PIECES_MAX: usize = 8;
/// Entries of the diagnostic buffer in one answer to an S7 client.
pub const EVENTS_LISTED_MAX: usize = 100;

/// How long a partner of the program may take to answer a job, or to send the next segment of a block.
pub const PARTNER_TIME: Duration = Duration::from_secs(10);
/// From one attempt to reach a partner to the next.
pub const PARTNER_PAUSE: Duration = Duration::from_secs(1);
/// Jobs whose answers a partner owes, and blocks that it sends at once.
pub const PARTNER_JOBS_MAX: usize = 8;
pub const TRANSFERS_MAX: usize = 16;

/// Wrong passwords of a computer before it has to wait, and how long.
pub const WRONG_PASSWORDS_MAX: u32 = 3;
pub const PASSWORD_PAUSE: Duration = Duration::from_secs(5);
/// Pause before a wrong password of a user is answered.
pub const WRONG_PASSWORD_PAUSE: Duration = Duration::from_secs(1);
/// Computers whose wrong passwords are counted.
pub const GUESSERS_MAX: usize = 1024;

/// The longest head of an HTTP request.
pub const HTTP_BYTES_MAX: usize = 8192;
/// How long a CPU may take to tell its state.
pub const STATE_TIME: Duration = Duration::from_secs(1);

/// Users that are signed in on the page at once; the one that was signed in longest makes room. And how long a session lasts without a
/// sign of life.
pub const SESSIONS_MAX: usize = 64;
pub const SESSION_TIME: Duration = Duration::from_secs(12 * 3600);
/// Browsers that get values at the same time.
pub const PAGES_MAX: usize = 16;
/// The longest message of a page.
pub const PAGE_MESSAGE_MAX: usize = 256 * 1024;
/// The longest program that is loaded, and how long it may take to come.
pub const PROGRAM_MAX: usize = 256 << 20;
pub const PROGRAM_TIME: Duration = Duration::from_secs(60);
/// Bytes of a name and a password.
pub const SIGN_IN_MAX: usize = 4096;
/// Watch tables of the project that are listed.
pub const TABLES_MAX: usize = 200;
/// Letters of the name of a watch table.
pub const TABLE_NAME_MAX: usize = 64;
/// Names that a page lists at most; others can be typed.
pub const NAMES_MAX: usize = 20_000;
/// Samples of a trace in one message.
pub const SAMPLES_SENT_MAX: usize = 10_000;
/// Values that one page may watch, and letters of a name.
pub const WATCHED_MAX: usize = 2_000;
pub const NAME_MAX: usize = 500;
/// Values that one order of a page modifies, and letters of all of them: the cycle waits while they are written. As many as a watch table has.
pub const MODIFIED_MAX: usize = 1_024;
pub const MODIFIED_LETTERS_MAX: usize = 16_384;

/// Of OPC UA: bytes of a request and of a response, chunks of a request, and bytes of a chunk.
pub const OPCUA_REQUEST_MAX: usize = 1024 * 1024;
pub const OPCUA_RESPONSE_MAX: usize = 4 * 1024 * 1024;
pub const OPCUA_CHUNKS_MAX: usize = 64;
pub const OPCUA_CHUNK_MAX: usize = 65_536;
/// The longest message that opens a channel: it is decrypted, which takes time.
pub const OPCUA_OPEN_MAX: usize = 8192;
/// The longest first message of a client, and the longest URL that is given back to it.
pub const OPCUA_HELLO_MAX: usize = 8192;
pub const OPCUA_URL_MAX: usize = 256;
/// Nodes of one request, those that it may browse, and what it may read: elements, or 32 bytes of a text each.
pub const OPCUA_NODES_MAX: usize = 1_000;
pub const OPCUA_BROWSED_MAX: usize = 100;
pub const OPCUA_READ_MAX: u32 = 512 * 1024;
/// Elements of an array that is one value, and elements that a browser gets.
pub const OPCUA_ELEMENTS_MAX: u32 = 65_536;
pub const OPCUA_LISTED_MAX: usize = 1_000;
/// Parts of a path of names.
pub const OPCUA_PATH_MAX: usize = 64;
/// References in one response; the rest is asked for with a continuation point.
pub const OPCUA_REFERENCES_MAX: usize = 5_000;
pub const OPCUA_CONTINUATIONS_MAX: usize = 10;
/// Of a session: subscriptions, monitored items, values that wait in an item and elements that wait in all of them, publish requests;
/// of a subscription: messages that wait to be acknowledged, and their bytes.
pub const OPCUA_SUBSCRIPTIONS_MAX: usize = 10;
pub const OPCUA_ITEMS_MAX: usize = 2_000;
pub const OPCUA_QUEUE_MAX: usize = 100;
pub const OPCUA_KEPT_MAX: u32 = 256 * 1024;
pub const OPCUA_PUBLISHES_MAX: usize = 20;
pub const OPCUA_UNACKNOWLEDGED_MAX: usize = 20;
pub const OPCUA_UNACKNOWLEDGED_BYTES_MAX: usize = 1024 * 1024;
/// Of a session: items that watch events; of such an item: fields, and conditions with their operands; events of one message.
pub const OPCUA_EVENT_ITEMS_MAX: usize = 10;
pub const OPCUA_EVENT_FIELDS_MAX: usize = 100;
pub const OPCUA_EVENT_OPERANDS_MAX: usize = 1_000;
pub const OPCUA_EVENTS_MAX: usize = 50;
/// The shortest time from one look at a value to the next.
pub const OPCUA_SAMPLING_MIN: Duration = Duration::from_millis(50);
/// The longest time between two looks or two publications.
pub const OPCUA_INTERVAL_MAX: Duration = Duration::from_secs(3600);
/// Publications without news until one is sent anyway, and without a request until the subscription ends.
pub const OPCUA_KEEP_ALIVE_MAX: u32 = 1000;
pub const OPCUA_LIFETIME_MAX: u32 = 3000;
/// How long a session lasts without a request, and a channel until its keys are renewed.
pub const OPCUA_SESSION_TIME: std::ops::RangeInclusive<Duration> = Duration::from_secs(10)..=Duration::from_secs(3600);
pub const OPCUA_CHANNEL_TIME: std::ops::RangeInclusive<Duration> = Duration::from_secs(10)..=Duration::from_secs(3600);

/// Bytes of a message of a broker, and of one to it.
pub const MQTT_RECEIVED_MAX: usize = 1024 * 1024;
pub const MQTT_SENT_MAX: usize = 64 * 1024 * 1024;
/// Values that are published.
pub const PUBLISHED_MAX: usize = 1000;
/// Silence until a broker is asked whether it is there; from one try to reach it to the next, at first and at last.
pub const MQTT_KEEP_ALIVE: Duration = Duration::from_secs(5);
pub const MQTT_RETRY: std::ops::RangeInclusive<Duration> = Duration::from_millis(250)..=Duration::from_secs(10);
/// Commands of Sparkplug B that wait for the CPU, and metrics of one.
pub const COMMANDS_MAX: usize = 64;
pub const COMMAND_METRICS_MAX: usize = 1_000;
/// How long the name of a broker may take to be looked up.
pub const LOOKUP_TIME: Duration = Duration::from_secs(5);
