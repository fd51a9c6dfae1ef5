#include "tests/allocations.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {
std::atomic<long> made{0};
}  // namespace

#if defined(__has_feature)
#define SEAMWRIGHT_THREAD_SANITIZER __has_feature(thread_sanitizer)
#else
#define SEAMWRIGHT_THREAD_SANITIZER 0
#endif
#if SEAMWRIGHT_THREAD_SANITIZER  // brings operators of its own, which can't be replaced; it counts malloc() too
#include <sanitizer/allocator_interface.h>
namespace {
[[maybe_unused]] const int counting = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++made; }, [](const volatile void*) {});
}  // namespace
#else
namespace {
void* counted(std::size_t bytes, std::size_t alignment) {
    ++made;
    void* p = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
    if (!p) throw std::bad_alloc();
    return p;
}
}  // namespace
void* operator new(std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new[](std::size_t bytes) {
    return counted(bytes, alignof(std::max_align_t));
}
void* operator new(std::size_t bytes, std::align_val_t a) {
    return counted(bytes, static_cast<std::size_t>(a));
}
void* operator new[](std::size_t bytes, std::align_val_t a) {
    return counted(bytes, static_cast<std::size_t>(a));
}
// The sanitizer's own variants that do not throw would take from another heap than the deletes below give back to.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    ++made;
    return std::malloc(bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t&) noexcept {
    ++made;
    return std::malloc(bytes);
}
void operator delete(void* p) noexcept {
    std::free(p);
}
void operator delete[](void* p) noexcept {
    std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
    std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
    std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
    std::free(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
    std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
    std::free(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
    std::free(p);
}

#endif

long seamwright::allocations_so_far() {
    return made;
}
