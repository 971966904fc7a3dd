//! Tests of orders without a broker, of days with one that is killed, and of the connection with Debian's Mosquitto.

mod cleaning;
mod day;
mod mosquitto;
mod orders;
