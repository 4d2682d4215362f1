#include "streaming/load_jobs.h"

#include <algorithm>
#include <exception>

namespace sahel {

void LoadMailbox::run(LoadJob& job, uint32_t slot, uint64_t sequence, TileKey key,
                      std::shared_ptr<const TileContext> parent) {
    {
        const std::lock_guard lock(mutex_);
        if (closed_ || !job.begin()) return;
        ++running_;
    }
    Completion done{slot, sequence, Error{}};
    try { // libraries below may throw, above all for want of memory
        done.result = load_(key, parent);
    } catch (const std::exception& e) {
        done.result = Error{ErrorKind::io, std::string("loading a tile threw: ") + e.what()};
    }
    parent.reset(); // whoever sees the result must not find its parent held for a moment more
    const std::lock_guard lock(mutex_);
    --running_;
    done_.push_back(std::move(done));
    changed_.notify_all();
}

void LoadMailbox::take(std::vector<Completion>& arrived) {
    arrived.clear();
    {
        const std::lock_guard lock(mutex_);
        arrived.swap(done_);
    }
    std::sort(arrived.begin(), arrived.end(),
              [](const Completion& a, const Completion& b) { return a.sequence < b.sequence; });
}

void LoadMailbox::take_one(std::vector<Completion>& arrived, uint64_t sequence) {
    arrived.clear();
    std::unique_lock lock(mutex_);
    auto found = done_.end();
    changed_.wait(lock, [&] {
        found = std::find_if(done_.begin(), done_.end(), [&](const Completion& c) { return c.sequence == sequence; });
        return found != done_.end();
    });
    arrived.push_back(std::move(*found));
    done_.erase(found);
}

void LoadMailbox::close() {
    std::unique_lock lock(mutex_);
    closed_ = true;
    changed_.wait(lock, [this] { return running_ == 0; });
    done_.clear();
}

std::shared_ptr<const TileContext> ContextAccount::count(std::shared_ptr<const TileContext> context) const {
    struct Holder {
        std::shared_ptr<const TileContext> held;
        std::shared_ptr<std::atomic<uint64_t>> account;
        uint64_t bytes;
        Holder(std::shared_ptr<const TileContext> c, std::shared_ptr<std::atomic<uint64_t>> a)
            : held(std::move(c)), account(std::move(a)), bytes(held->bytes()) {
            *account += bytes;
        }
        Holder(const Holder&) = delete;
        Holder& operator=(const Holder&) = delete;
        ~Holder() {
            held.reset();
            *account -= bytes;
        }
    };
    if (!context) return nullptr;
    const auto holder = std::make_shared<Holder>(std::move(context), bytes_);
    return {holder, holder->held.get()};
}

} // namespace sahel
