// The only place that makes threads. Built with PAC_THREADS=0 everything runs on the caller's thread, same results.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>

namespace pac {

// Processors that this process may use; at least 1.
int hardware_thread_count();

// A fixed set of worker threads. One object, one caller at a time; destroying it joins the workers.
class ThreadPool {
 public:
  // n_threads >= 1 counts the calling thread: 1 makes no thread at all. 0 = hardware_thread_count().
  explicit ThreadPool(int n_threads = 0);
  ~ThreadPool();
  ThreadPool(ThreadPool&&) noexcept;
  ThreadPool& operator=(ThreadPool&&) noexcept;

  int thread_count() const;

  // Calls fn(index) once for each index in [0, count), in no particular order, on all threads; returns when all are
  // done. fn must not throw and must not call back into this pool.
  template <class Fn>
  void for_each(int64_t count, Fn&& fn) {
    run(
        count, [](void* context, int64_t index) { (*static_cast<std::remove_reference_t<Fn>*>(context))(index); }, &fn);
  }

  // Calls fn(chain, step) for each step in [0, lengths[chain]) of each chain: the steps of a chain one after another in
  // order, chains side by side, and a thread goes on with the chain that has most steps left. Otherwise as for_each().
  template <class Fn>
  void for_each_step(std::span<const int> lengths, Fn&& fn) {
    run_steps(
        lengths,
        [](void* context, int chain, int step) { (*static_cast<std::remove_reference_t<Fn>*>(context))(chain, step); },
        &fn);
  }

 private:
  void run_steps(std::span<const int> lengths, void (*call)(void*, int, int), void* context);
  void run(int64_t count, void (*call)(void*, int64_t), void* context);
  struct State;
  std::unique_ptr<State> state_;
};

// A pool for one loop: for loops that take milliseconds or more.
template <class Fn>
void parallel_for(int n_threads, int64_t count, Fn&& fn) {
  ThreadPool(n_threads).for_each(count, fn);
}

}  // namespace pac
