//! Recordings from outside: what is written is read back, whatever the disk
//! does.

mod any;
mod cut;
mod damage;
mod damaged_ends;
mod disks;
mod flight;
mod folder;
mod foxglove_layout;
mod full_disk;
mod old_format;
mod round_trip;
mod slow_disk;
