//! Tests of orders without a broker, and of the connection with Debian's Mosquitto.

mod mosquitto;
mod orders;
