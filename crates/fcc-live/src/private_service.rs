//! The kind of iceoryx2's services that is used: all of their files are in one
//! folder.
//!
//! iceoryx2's own kinds put shared memory beside that of all users into
//! `/dev/shm`, with one segment that is open to every user.

use std::fmt::Debug;

use iceoryx2::prelude::ZeroCopySend;
use iceoryx2::service;
use iceoryx2::unique_id_generator::unique_system_id::UniqueSystemId;
use iceoryx2_bb_elementary_traits::testing::abandonable::Abandonable;
use iceoryx2_cal::shm_allocator::bump_allocator::BumpAllocator;
use iceoryx2_cal::shm_allocator::pool_allocator::PoolAllocator;
use iceoryx2_cal::{
    arc_sync_policy, bag, dynamic_storage, event, hash, monitoring, reactor,
    resizable_shared_memory, serialize, shared_memory, static_storage, zero_copy_connection,
};

/// Shared memory between processes, in files of the configured root folder.
/// Both sides may move between threads, as a Python program's objects do.
#[derive(Clone, Debug)]
pub(super) struct PrivateService;

impl service::Service for PrivateService {
    type StaticStorage = static_storage::file::Storage;
    type ConfigSerializer = serialize::recommended::Recommended;
    type PersistentDynamicStorage<T: Debug + Send + Sync + ZeroCopySend + 'static> =
        dynamic_storage::file::Storage<T>;
    type Bag = bag::recommended::Recommended;
    type DynamicStorage<T: Debug + Send + Sync + ZeroCopySend + 'static> =
        dynamic_storage::file::Storage<T>;
    type ServiceNameHasher = hash::recommended::Recommended;
    type SharedMemory = shared_memory::file::Memory<PoolAllocator>;
    type ResizableSharedMemory =
        resizable_shared_memory::dynamic::DynamicMemory<PoolAllocator, Self::SharedMemory>;
    type Connection = zero_copy_connection::file::Connection;
    // Events are not used.
    type Event = event::recommended::Local;
    type Monitoring = monitoring::file_lock::FileLockMonitoring;
    type Reactor = reactor::recommended::Ipc;
    type ArcThreadSafetyPolicy<T: Send + Debug + Abandonable> =
        arc_sync_policy::mutex_protected::MutexProtected<T>;
    type BlackboardMgmt<T: Send + Sync + Debug + ZeroCopySend + 'static> =
        dynamic_storage::file::Storage<T>;
    type BlackboardPayload = shared_memory::file::Memory<BumpAllocator>;
    type UniqueId = UniqueSystemId;
}

impl service::internal::ServiceInternal<Self> for PrivateService {}
