// parallel.cpp: the team of threads behind the loops.
#include "core/parallel.h"

#include <pthread.h>
#include <sched.h>

#include <atomic>
#include <csignal>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

namespace kiln {

namespace {

constexpr int spins = 1000;  // looks for more work, some tens of microseconds, before a thread sleeps

thread_local bool in_loop = false;

void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/// Processors that this process may use.
int processors() {
    cpu_set_t allowed;
    if (sched_getaffinity(0, sizeof allowed, &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Signals are for the thread that began the program: it may have to give up waiting for input.
class NoSignals {
   public:
    NoSignals() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    NoSignals(const NoSignals&) = delete;
    NoSignals& operator=(const NoSignals&) = delete;
    ~NoSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

   private:
    sigset_t before_;
};

/// Threads that wait for loops. A loop gives each a range of pieces. What is left of a range stands in one word with the number of
/// the loop, so that no one who comes late takes a piece of another loop: a piece can be taken only while its loop waits for it,
/// and what the loop consists of stays as it is until all its pieces are done.
class Team {
   public:
    explicit Team(int size) : ranges_(static_cast<std::size_t>(size)) {
        const NoSignals inherited;
        for (std::size_t member = 1; member < ranges_.size(); ++member)
            workers_.emplace_back([this, member](const std::stop_token& stop) { wait_for_loops(member, stop); });
    }

    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    ~Team() {
        for (std::jthread& worker : workers_) worker.request_stop();
        announced_.fetch_add(1);
        announced_.notify_all();
    }

    int size() const { return static_cast<int>(ranges_.size()); }

    void run(std::size_t pieces, void (*work)(const void*, std::size_t), const void* context) {
        work_.store(work, std::memory_order_relaxed);
        context_.store(context, std::memory_order_relaxed);
        pieces_.store(pieces, std::memory_order_relaxed);
        undone_.store(static_cast<std::uint32_t>(pieces), std::memory_order_relaxed);
        const std::uint32_t loop = announced_.load(std::memory_order_relaxed) + 1;
        for (std::size_t range = 0; range < ranges_.size(); ++range)
            ranges_[range].left.store(std::uint64_t{loop} << 32 | (end_of(range, pieces) - end_of(range - 1, pieces)),
                                      std::memory_order_release);
        announced_.store(loop);
        announced_.notify_all();
        take_pieces(0, loop);
        for (int spin = 0; undone_.load(std::memory_order_acquire) != 0; ++spin) {
            if (spin < spins) pause();
            else if (const std::uint32_t left = undone_.load(std::memory_order_acquire); left != 0) undone_.wait(left);
        }
        if (const std::exception_ptr failure = std::exchange(failure_, nullptr)) std::rethrow_exception(failure);
    }

   private:
    struct alignas(64) Range {
        std::atomic<std::uint64_t> left{0};  // number of the loop and, in the lower half, how many pieces are left
    };

    /// Ranges count from 0; that before the first ends at 0.
    std::size_t end_of(std::size_t range, std::size_t pieces) const { return pieces * (range + 1) / ranges_.size(); }

    /// Takes pieces of all ranges, from its own on, until none is left.
    void take_pieces(std::size_t member, std::uint32_t loop) {
        for (std::size_t turn = 0; turn < ranges_.size(); ++turn) {
            const std::size_t range = (member + turn) % ranges_.size();
            std::uint64_t now = ranges_[range].left.load(std::memory_order_acquire);
            while (now >> 32 == loop) {
                const std::uint32_t left = static_cast<std::uint32_t>(now);
                if (left == 0) break;
                const auto work = work_.load(std::memory_order_relaxed);
                const void* const context = context_.load(std::memory_order_relaxed);
                const std::size_t end = end_of(range, pieces_.load(std::memory_order_relaxed));
                if (!ranges_[range].left.compare_exchange_weak(now, now - 1, std::memory_order_acq_rel)) continue;
                call(work, context, end - left);
                if (undone_.fetch_sub(1, std::memory_order_acq_rel) == 1 && member != 0) undone_.notify_one();
                now = ranges_[range].left.load(std::memory_order_acquire);
            }
        }
    }

    void call(void (*work)(const void*, std::size_t), const void* context, std::size_t piece) {
        try {
            work(context, piece);
        } catch (...) {
            const std::scoped_lock lock(failing_);
            if (!failure_ || piece < failed_piece_) {
                failure_ = std::current_exception();
                failed_piece_ = piece;
            }
        }
    }

    void wait_for_loops(std::size_t member, const std::stop_token& stop) {
        in_loop = true;
        std::uint32_t seen = 0;
        while (true) {
            for (int spin = 0; spin < spins && announced_.load(std::memory_order_acquire) == seen; ++spin) pause();
            announced_.wait(seen);
            if (stop.stop_requested()) return;
            seen = announced_.load(std::memory_order_acquire);
            take_pieces(member, seen);
        }
    }

    std::vector<Range> ranges_;
    std::atomic<void (*)(const void*, std::size_t)> work_{nullptr};
    std::atomic<const void*> context_{nullptr};
    std::atomic<std::size_t> pieces_{0};
    alignas(64) std::atomic<std::uint32_t> announced_{0};  // number of the last loop
    alignas(64) std::atomic<std::uint32_t> undone_{0};     // pieces of it
    std::mutex failing_;
    std::exception_ptr failure_;
    std::size_t failed_piece_ = 0;
    std::vector<std::jthread> workers_;  // last: they use the rest
};

std::atomic<int> wanted{0};  // threads; 0: as many as processors

std::mutex running;  // held by the loop that has the team

/// Made by the first loop that asks for it.
Team& team() {
    static std::unique_ptr<Team> team;
    if (!team || team->size() != threads()) team = std::make_unique<Team>(threads());
    return *team;
}

}  // namespace

int threads() {
    static const int available = processors();
    const int count = wanted.load(std::memory_order_relaxed);
    return count > 0 ? count : available;
}

void set_threads(int count) { wanted.store(std::max(1, count)); }

void share_pieces(std::size_t pieces, void (*work)(const void*, std::size_t), const void* context) {
    std::unique_lock<std::mutex> alone;
    if (!in_loop) alone = std::unique_lock(running, std::try_to_lock);
    if (!alone.owns_lock() || threads() == 1 || pieces < 2) {
        for (std::size_t piece = 0; piece < pieces; ++piece) work(context, piece);
        return;
    }
    in_loop = true;
    struct Leave {
        ~Leave() { in_loop = false; }
    } leave;
    team().run(pieces, work, context);
}

}  // namespace kiln
