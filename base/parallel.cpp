#include "base/parallel.h"

#include <utility>

#ifndef PAC_THREADS
#define PAC_THREADS 1
#endif

#if PAC_THREADS
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>
#endif

namespace pac {

static void run_steps_in_order(std::span<const int> lengths, void (*call)(void*, int, int), void* context) {
  for (int chain = 0; chain < static_cast<int>(lengths.size()); ++chain)
    for (int step = 0; step < lengths[static_cast<size_t>(chain)]; ++step) call(context, chain, step);
}

#if PAC_THREADS

// Some ten microseconds: loops follow one another, and to wake a thread that sleeps takes longer than to watch that
// long. Returns whether `done` became true.
template <class Done>
bool watch(bool worthwhile, Done&& done) {
  constexpr int kTries = 2000;
  for (int i = 0; worthwhile && i < kTries; ++i) {
    if (done()) return true;
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
  }
  return done();
}

// A job is published under the mutex with a new generation number; workers take indices from `next` until none is left.
struct ThreadPool::State {
  std::mutex mutex;
  std::condition_variable wake, done;
  std::vector<std::thread> workers;
  void (*call)(void*, int64_t) = nullptr;
  void* context = nullptr;
  int64_t count = 0;
  std::atomic<int64_t> next{0};
  std::atomic<uint64_t> generation{0};
  std::atomic<int> n_active{0};
  std::atomic<bool> stop{false};
  bool has_processors = false;  // one for each thread

  void take_indices() {
    for (int64_t i = next.fetch_add(1); i < count; i = next.fetch_add(1)) call(context, i);
  }
  void worker_loop() {
    uint64_t seen = 0;
    std::unique_lock lock(mutex);
    const auto is_called = [&] { return stop || generation != seen; };
    while (true) {
      wake.wait(lock, is_called);
      if (stop) return;
      seen = generation;
      lock.unlock();
      take_indices();
      lock.lock();
      if (--n_active == 0) done.notify_one();
      lock.unlock();
      watch(has_processors, is_called);
      lock.lock();
    }
  }
};

int hardware_thread_count() {
  const unsigned n = std::thread::hardware_concurrency();
  return n == 0 ? 1 : static_cast<int>(n);
}

ThreadPool::ThreadPool(int n_threads) : state_(new State) {
  if (n_threads <= 0) n_threads = hardware_thread_count();
  state_->has_processors = n_threads <= hardware_thread_count();
  state_->workers.reserve(static_cast<size_t>(n_threads - 1));
  for (int i = 1; i < n_threads; ++i) state_->workers.emplace_back([state = state_.get()] { state->worker_loop(); });
}

ThreadPool::~ThreadPool() {
  if (state_ == nullptr) return;
  {
    std::lock_guard lock(state_->mutex);
    state_->stop = true;
  }
  state_->wake.notify_all();
  for (std::thread& worker : state_->workers) worker.join();
}

int ThreadPool::thread_count() const {
  return 1 + static_cast<int>(state_->workers.size());
}

void ThreadPool::run(int64_t count, void (*call)(void*, int64_t), void* context) {
  State& state = *state_;
  if (state.workers.empty() || count <= 1) {
    for (int64_t i = 0; i < count; ++i) call(context, i);
    return;
  }
  {
    std::lock_guard lock(state.mutex);
    state.call = call;
    state.context = context;
    state.count = count;
    state.next.store(0);
    state.n_active = static_cast<int>(state.workers.size());
    ++state.generation;
  }
  state.wake.notify_all();
  state.take_indices();
  const auto is_done = [&] { return state.n_active == 0; };
  watch(state.has_processors, is_done);
  std::unique_lock lock(state.mutex);
  state.done.wait(lock, is_done);
}

// Who takes a step next, and of which chain.
class ChainQueue {
 public:
  explicit ChainQueue(std::span<const int> lengths) : chains_(lengths.size()) {
    for (size_t i = 0; i < lengths.size(); ++i) chains_[i].length = lengths[i];
  }

  // The chain whose step `last` (-1: none) is done, or another that nobody is busy with; -1: there is none. Then as
  // many threads are busy as chains are left: nobody is missed who leaves.
  int take(int last) {
    std::lock_guard lock(mutex_);
    if (last >= 0) at(last).is_busy = false;
    int best = last >= 0 && left(last) > 0 ? last : -1;
    for (int i = 0; i < static_cast<int>(chains_.size()); ++i)
      if (!at(i).is_busy && left(i) > (best >= 0 ? left(best) : 0)) best = i;
    if (best >= 0) at(best).is_busy = true;
    return best;
  }
  // Of a chain that was taken.
  int next_step(int chain) { return at(chain).next++; }

 private:
  struct Chain {
    int next = 0, length = 0;
    bool is_busy = false;
  };
  Chain& at(int i) { return chains_[static_cast<size_t>(i)]; }
  int left(int i) { return at(i).length - at(i).next; }

  std::mutex mutex_;
  std::vector<Chain> chains_;
};

void ThreadPool::run_steps(std::span<const int> lengths, void (*call)(void*, int, int), void* context) {
  if (thread_count() == 1 || lengths.size() < 2) return run_steps_in_order(lengths, call, context);
  ChainQueue queue(lengths);
  for_each(thread_count(), [&](int64_t) {
    for (int chain = queue.take(-1); chain >= 0; chain = queue.take(chain))
      call(context, chain, queue.next_step(chain));
  });
}

#else

struct ThreadPool::State {};
int hardware_thread_count() {
  return 1;
}
ThreadPool::ThreadPool(int) : state_(new State) {}
ThreadPool::~ThreadPool() = default;
int ThreadPool::thread_count() const {
  return 1;
}
void ThreadPool::run(int64_t count, void (*call)(void*, int64_t), void* context) {
  for (int64_t i = 0; i < count; ++i) call(context, i);
}
void ThreadPool::run_steps(std::span<const int> lengths, void (*call)(void*, int, int), void* context) {
  run_steps_in_order(lengths, call, context);
}

#endif

ThreadPool::ThreadPool(ThreadPool&&) noexcept = default;
ThreadPool& ThreadPool::operator=(ThreadPool&& other) noexcept {
  std::swap(state_, other.state_);  // the old workers are joined when `other` goes
  return *this;
}

}  // namespace pac
