//! What clients may use up: connections, sizes, times. All limits of all services are here.

use std::time::Duration;

/// Connections of one service at once, and those of one computer among them.
pub const CONNECTIONS_MAX: usize = 32;
pub const CONNECTIONS_OF_ONE_MAX: usize = 8;

/// How long an S7 client may take to ask for a connection, and to agree on the length of PDUs.
pub const CONNECT_TIME: Duration = Duration::from_secs(5);
pub const SETUP_TIME: Duration = Duration::from_secs(10);
/// How long any client may take to complete a frame that has begun, and to take an answer.
pub const FRAME_TIME: Duration = Duration::from_secs(5);
pub const ANSWER_TIME: Duration = Duration::from_secs(5);

/// Requests that wait for the CPU; who has more waits.
pub const QUEUE_MAX: usize = 64;

/// Cyclic jobs of an S7 connection, and variables of one.
pub const SUBSCRIPTIONS_MAX: usize = 16;
pub const SUBSCRIBED_ITEMS_MAX: usize = 20;

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
/// Browsers that are told values at once.
pub const PAGES_MAX: usize = 16;
/// The longest message of a page.
pub const PAGE_MESSAGE_MAX: usize = 256 * 1024;
/// The longest program that is loaded.
pub const PROGRAM_MAX: usize = 256 << 20;
/// Values that one page may watch, and letters of a name.
pub const WATCHED_MAX: usize = 2_000;
pub const NAME_MAX: usize = 500;
