#pragma once

#include "streaming/streamer.h"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

/// The border between the owner's thread and the workers. Jobs share a mailbox that outlives the streamer, so a job
/// that runs late finds something to talk to; everything else of the streamer belongs to the owner alone.
///
///     owner: submit --> waiting --worker--> begun --> result in the mailbox --> owner: take, by sequence
///                          +----owner----> abandoned (the job then does nothing; its reservations are free at once)
namespace sahel {

/// One load on its way. Either the worker begins it or the owner abandons it, never both.
class LoadJob {
  public:
    bool begin() { return leave_waiting(1); }
    bool abandon() { return leave_waiting(2); }

  private:
    bool leave_waiting(int to) {
        int waiting = 0;
        return stage_.compare_exchange_strong(waiting, to);
    }
    std::atomic<int> stage_{0};
};

struct Completion {
    uint32_t slot;
    uint64_t sequence;
    Result<std::unique_ptr<TilePayload>> result;
};

class LoadMailbox {
  public:
    using Load =
        std::function<Result<std::unique_ptr<TilePayload>>(TileKey, const std::shared_ptr<const TileContext>&)>;
    explicit LoadMailbox(Load load) : load_(std::move(load)) {}

    /// Any worker thread.
    void run(LoadJob& job, uint32_t slot, uint64_t sequence, TileKey key, std::shared_ptr<const TileContext> parent);
    /// Owner: what has arrived, in the order of the requests whatever order the workers finished in.
    void take(std::vector<Completion>& arrived);
    /// Owner: waits for this load and takes it alone.
    void take_one(std::vector<Completion>& arrived, uint64_t sequence);
    /// Owner: jobs that have not begun will not; returns when none is running.
    void close();

  private:
    Load load_;
    std::mutex mutex_; ///< guards all below
    std::condition_variable changed_;
    std::vector<Completion> done_;
    int running_ = 0;
    bool closed_ = false;
};

/// Bytes of contexts alive. Contexts hold their parents and travel to workers, so only their destructors know.
class ContextAccount {
  public:
    /// The same context; its bytes count until the last holder lets go.
    std::shared_ptr<const TileContext> count(std::shared_ptr<const TileContext> context) const;
    [[nodiscard]] uint64_t bytes() const { return bytes_->load(); }

  private:
    std::shared_ptr<std::atomic<uint64_t>> bytes_ = std::make_shared<std::atomic<uint64_t>>(0);
};

} // namespace sahel
