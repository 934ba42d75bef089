#include "drivers/os/thread.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

namespace roomcal::drivers {

namespace {

constexpr uint64_t kPaint = 0xC5A1'5EA7'ED57'AC4BU;  // no address and no small number looks like it

void paint(std::span<std::byte> stack) {
  for (std::size_t at = 0; at < stack.size(); at += sizeof kPaint)
    std::memcpy(stack.data() + at, &kPaint, sizeof kPaint);
}

// The sanitizer would take looking at another thread's stack for a bug.
__attribute__((no_sanitize("address"))) std::size_t painted_bytes(std::span<const std::byte> stack) {
  const auto* words = reinterpret_cast<const volatile uint64_t*>(stack.data());
  std::size_t i = 0;
  while (i < stack.size() / sizeof kPaint && words[i] == kPaint) ++i;
  return i * sizeof kPaint;
}

}  // namespace

Status Thread::take_stack(const ThreadOptions& options, std::span<std::byte> given) {
  if (given.empty()) {
    ROOMCAL_TRY(own_.reserve(std::max<std::size_t>(options.stack_bytes, 1)));
    given = own_.bytes();
  }
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  if (reinterpret_cast<std::uintptr_t>(given.data()) % page != 0 || given.size() % page != 0)
    return {StatusCode::kInvalidArgument, "a thread's stack must be whole pages"};
  if (given.size() < page + static_cast<std::size_t>(::sysconf(_SC_THREAD_STACK_MIN)))
    return {StatusCode::kInvalidArgument, "a thread's stack is below what the C library needs"};
  guard_ = given.first(page);
  stack_ = given.subspan(page);
  paint(stack_);
  if (::mprotect(guard_.data(), guard_.size(), PROT_NONE) != 0)
    return {StatusCode::kUnavailable, "a thread's guard page cannot be protected; raise vm.max_map_count"};
  return ok_status();
}

Status Thread::launch() {
  pthread_attr_t attributes;
  if (::pthread_attr_init(&attributes) != 0) return {StatusCode::kOutOfMemory, "a thread's attributes"};
  ::pthread_attr_setstack(&attributes, stack_.data(), stack_.size());
  const int error = ::pthread_create(&thread_, &attributes, &Thread::enter, this);
  ::pthread_attr_destroy(&attributes);
  if (error == 0) return ok_status();
  ::mprotect(guard_.data(), guard_.size(), PROT_READ | PROT_WRITE);
  return {StatusCode::kUnavailable, "the system allows no further thread; raise TasksMax= of the service or ulimit -u"};
}

void Thread::set_priority(int fifo_priority) {
  priority_status_ = ok_status();
  if (fifo_priority == 0) return;
  sched_param parameters{};
  parameters.sched_priority = fifo_priority;
  if (::pthread_setschedparam(thread_, SCHED_FIFO, &parameters) == 0) return;
  priority_status_ = {StatusCode::kUnavailable,
                      "a thread has no real-time priority; allow LimitRTPRIO= of the service or CAP_SYS_NICE"};
}

Status Thread::start(const ThreadOptions& options, Body& body, std::span<std::byte> stack) {
  if (running_) return {StatusCode::kUnavailable, "the thread runs already"};
  name_ = options.name;
  body_ = &body;
  guard_ = stack_ = {};
  ROOMCAL_TRY(take_stack(options, stack));
  ROOMCAL_TRY(launch());
  running_ = true;
  set_priority(options.fifo_priority);
  return ok_status();
}

void* Thread::enter(void* self) {
  auto& thread = *static_cast<Thread*>(self);
  std::array<char, 16> name{};
  std::copy(thread.name_.view().begin(), thread.name_.view().end(), name.begin());
  if (name[0] != '\0') ::pthread_setname_np(::pthread_self(), name.data());
  thread.body_->run();
  return nullptr;
}

void Thread::join() {
  if (!running_) return;
  ::pthread_join(thread_, nullptr);
  ::mprotect(guard_.data(), guard_.size(), PROT_READ | PROT_WRITE);
  running_ = false;
}

std::size_t Thread::stack_peak() const { return stack_.size() - painted_bytes(stack_); }

}  // namespace roomcal::drivers
