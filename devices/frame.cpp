#include "devices/frame.h"

#include <cassert>
#include <cstddef>
#include <mutex>
#include <new>

namespace seamwright {

std::string_view to_string(FrameStatus status) {
    switch (status) {
        case FrameStatus::ok:
            return "ok";
        case FrameStatus::incomplete:
            return "incomplete";
        case FrameStatus::corrupt:
            return "corrupt";
        case FrameStatus::late:
            return "late";
    }
    return "unknown";
}

// A slot holds a frame and room for the shared_ptr's control block, so that acquire() allocates nothing. The
// slot is free again when the control block goes, that is when neither FramePtr nor weak_ptr points at it.
struct FramePool::State {
    static constexpr std::size_t kBlockBytes = 128;
    struct Slot {
        Frame frame;
        alignas(std::max_align_t) std::byte block[kBlockBytes];
    };
    explicit State(std::size_t n) : slots(std::make_unique<Slot[]>(n)), size(n) {
        free.reserve(n);
        for (std::size_t i = n; i-- > 0;) free.push_back(&slots[i]);
    }
    std::unique_ptr<Slot[]> slots;
    const std::size_t size;
    mutable std::mutex mutex;
    std::vector<Slot*> free;
};

namespace {

template <class T, class State, class Slot>
struct SlotAllocator {
    using value_type = T;
    template <class U>
    struct rebind {
        using other = SlotAllocator<U, State, Slot>;
    };
    std::shared_ptr<State> state;
    Slot* slot;

    SlotAllocator(std::shared_ptr<State> s, Slot* p) : state(std::move(s)), slot(p) {}
    template <class U>
    SlotAllocator(const SlotAllocator<U, State, Slot>& other) : state(other.state), slot(other.slot) {}

    T* allocate([[maybe_unused]] std::size_t n) {
        static_assert(sizeof(T) <= State::kBlockBytes && alignof(T) <= alignof(std::max_align_t));
        assert(n == 1);
        return reinterpret_cast<T*>(slot->block);
    }
    void deallocate(T*, std::size_t) {
        const std::lock_guard lock(state->mutex);
        state->free.push_back(slot);
    }
    template <class U>
    bool operator==(const SlotAllocator<U, State, Slot>& other) const {
        return slot == other.slot;
    }
};

}  // namespace

FramePool::FramePool(std::size_t size) : state_(std::make_shared<State>(size)) {}

FramePtr FramePool::acquire() {
    State::Slot* slot = nullptr;
    {
        const std::lock_guard lock(state_->mutex);
        if (state_->free.empty()) return nullptr;
        slot = state_->free.back();
        state_->free.pop_back();
    }
    Frame& f = slot->frame;
    f.status = FrameStatus::ok;
    f.sequence = 0;
    f.device_time_ns = f.host_time_ns = 0;
    f.base_from_flange.reset();
    f.spot_id.clear();
    f.image = {};
    f.profile.clear();
    const auto keep = [](Frame*) {};  // the frame lives in its slot
    return FramePtr(&f, keep, SlotAllocator<Frame, State, State::Slot>(state_, slot));
}

std::size_t FramePool::size() const {
    return state_->size;
}

std::size_t FramePool::free() const {
    const std::lock_guard lock(state_->mutex);
    return state_->free.size();
}

}  // namespace seamwright
