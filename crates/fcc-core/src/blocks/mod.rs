//! Control blocks: filters, limiters, PID. They know no plant.
