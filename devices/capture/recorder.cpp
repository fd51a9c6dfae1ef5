#include "devices/capture/recorder.h"

#include <zlib.h>

#include <algorithm>
#include <utility>

namespace seamwright {
namespace {

// A transaction holds no more than this, so that a recorder that fell behind commits as it catches up.
constexpr std::size_t kBatchBytes = std::size_t{32} << 20;
constexpr std::size_t kFreeBlocks = 64;       // kept for reuse
constexpr std::size_t kMaxEvents = 1u << 20;  // waiting for the disk

CaptureSource described(SourceKind kind, const std::string& name) {
    CaptureSource source;
    source.kind = kind;
    source.name = name;
    return source;
}

}  // namespace

Recorder::Recorder(CaptureWriter writer, const RecorderOptions& options)
    : options_(options), writer_(std::move(writer)) {}

Expected<std::unique_ptr<Recorder>> Recorder::create(const std::filesystem::path& path,
                                                     const RecorderOptions& options) {
    if (options.queue_mib < 4 || options.queue_mib > 65536)
        return input_error("must be 4 to 65536 MiB", "queue_mib");
    if (options.flush_ms < 10 || options.flush_ms > 10000)
        return input_error("must be 10 to 10000 ms", "flush_ms");
    SEAM_TRY(auto writer, CaptureWriter::create(path, options.limit_bytes));
    std::unique_ptr<Recorder> recorder(new Recorder(std::move(writer), options));
    recorder->thread_ = std::thread(&Recorder::write_loop, recorder.get());
    return recorder;
}

Recorder::~Recorder() {
    (void)finish("ended");
}

Expected<std::int64_t> Recorder::add_sensor(const std::string& name, const SensorIdentity& identity) {
    CaptureSource s = described(SourceKind::sensor, name);
    s.driver = identity.driver;
    s.vendor = identity.vendor;
    s.model = identity.model;
    s.serial = identity.serial;
    const std::lock_guard file(file_mutex_);
    const auto id = writer_.add_source(s);
    if (!id) return id;
    const std::lock_guard lock(mutex_);
    sources_[*id] = std::make_unique<Source>();
    sources_[*id]->name = name;
    return id;
}

Expected<std::int64_t> Recorder::add_robot(const std::string& name, const RobotIdentity& identity) {
    CaptureSource s = described(SourceKind::robot, name);
    s.driver = identity.driver;
    s.vendor = identity.brand;
    s.model = identity.model;
    s.serial = identity.serial;
    const std::lock_guard file(file_mutex_);
    return writer_.add_source(s);
}

Recorder::Source* Recorder::find(std::int64_t source) const {
    const std::lock_guard lock(mutex_);
    const auto it = sources_.find(source);
    return it == sources_.end() ? nullptr : it->second.get();
}

std::unique_ptr<Recorder::Pending> Recorder::take_block() {
    const std::lock_guard lock(mutex_);
    if (failure_ || finishing_) return nullptr;
    if (free_.empty()) return std::make_unique<Pending>();
    auto block = std::move(free_.back());
    free_.pop_back();
    return block;
}

void Recorder::hand_over(Source& source) {
    const std::lock_guard lock(mutex_);
    full_.push_back(std::move(source.open));
    wake_.notify_one();
}

void Recorder::frame(std::int64_t id, const Frame& frame, const ProfileCandidates* candidates) {
    Source* source = find(id);
    if (!source) return;
    const std::size_t bytes = frame_record_bytes(frame, candidates, options_.images);
    const std::lock_guard lock(source->mutex);
    if (source->last_sequence && frame.sequence > *source->last_sequence + 1)
        source->lost += frame.sequence - *source->last_sequence - 1;
    source->last_sequence = frame.sequence;
    if (waiting_bytes_.load() + bytes > static_cast<std::size_t>(options_.queue_mib) << 20) {
        ++source->dropped;
        return;
    }
    if (!source->open) source->open = take_block();
    if (!source->open) {
        ++source->dropped;
        return;
    }
    Pending& open = *source->open;
    const std::size_t before = open.block.bytes();
    if (!open.block.append(frame, candidates, options_.images)) {
        ++source->dropped;
        return;
    }
    waiting_bytes_ += open.block.bytes() - before;
    if (open.block.frames() == 1) {
        open.source = id;
        open.first_host_ns = frame.host_time_ns;
    }
    open.last_host_ns = frame.host_time_ns;
    if (frame.status != FrameStatus::ok) ++source->damaged;
    if (!frame.spot_id.empty()) open.spots.emplace_back(open.block.frames() - 1, frame.spot_id);
    if (open.block.bytes() >= kCaptureBlobBytes) hand_over(*source);
}

void Recorder::event(CaptureEvent event) {
    const std::lock_guard lock(mutex_);
    if (failure_ || finishing_ || events_.size() >= kMaxEvents) return;
    events_.push_back(std::move(event));
}

void Recorder::write_loop() {
    const std::chrono::milliseconds interval(options_.flush_ms);
    auto flushed = std::chrono::steady_clock::now();
    for (bool last = false; !last;) {
        std::vector<Source*> all;
        {
            std::unique_lock lock(mutex_);
            wake_.wait_until(lock, flushed + interval, [&] { return finishing_ || !full_.empty(); });
            last = finishing_;
            for (const auto& [id, source] : sources_) all.push_back(source.get());
        }
        const bool flush = std::chrono::steady_clock::now() >= flushed + interval;
        if (flush) flushed = std::chrono::steady_clock::now();
        // Half-full blocks go the way of the full ones, so that the order within a source holds.
        if (flush || last) {
            for (Source* source : all) {
                const std::lock_guard lock(source->mutex);
                if (source->open && source->open->block.frames() > 0) hand_over(*source);
            }
        }
        for (bool more = true; more;) {
            std::deque<std::unique_ptr<Pending>> blocks;
            std::vector<CaptureEvent> events;
            {
                const std::lock_guard lock(mutex_);
                for (std::size_t bytes = 0; !full_.empty() && bytes < kBatchBytes;) {
                    bytes += full_.front()->block.bytes();
                    blocks.push_back(std::move(full_.front()));
                    full_.pop_front();
                }
                events.swap(events_);
                more = last && !full_.empty();
            }
            write_batch(std::move(blocks), std::move(events));
        }
    }
}

void Recorder::write_batch(std::deque<std::unique_ptr<Pending>> blocks, std::vector<CaptureEvent> events) {
    std::map<std::int64_t, CaptureCounters> counters;
    std::map<std::int64_t, std::uint64_t> first;
    std::vector<std::pair<std::int64_t, Source*>> all;
    bool failed;
    {
        const std::lock_guard lock(mutex_);
        failed = failure_.has_value();
        for (const auto& [id, source] : sources_) {
            all.emplace_back(id, source.get());
            first[id] = source->committed;
        }
    }
    for (const auto& [id, source] : all) {
        const std::lock_guard lock(source->mutex);
        counters[id] = {0, source->damaged, source->lost, source->dropped};
    }
    std::size_t bytes = 0;
    std::uint64_t written = 0;
    std::map<std::int64_t, std::uint64_t> frames;
    Expected<void> done;
    std::vector<std::vector<std::byte>> packed;  // kept until the rows are in
    if (!failed && (!blocks.empty() || !events.empty())) {
        std::vector<CaptureWriter::Block> rows;
        for (const auto& pending : blocks) {
            CaptureWriter::Block& row = rows.emplace_back();
            row.source = pending->source;
            row.first = first[pending->source] + frames[pending->source];
            row.frames = pending->block.frames();
            row.first_host_ns = pending->first_host_ns;
            row.last_host_ns = pending->last_host_ns;
            row.bytes = pending->block.finish();
            for (auto& [index, spot] : pending->spots)
                row.spots.emplace_back(row.first + static_cast<std::uint64_t>(index), spot);
            // Packing is left out while more than a quarter of the memory waits.
            if (options_.compress &&
                waiting_bytes_.load() < (static_cast<std::size_t>(options_.queue_mib) << 20) / 4) {
                uLongf size = ::compressBound(static_cast<uLong>(row.bytes.size()));
                std::vector<std::byte>& out = packed.emplace_back(size);
                if (::compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                                reinterpret_cast<const Bytef*>(row.bytes.data()),
                                static_cast<uLong>(row.bytes.size()), 1) == Z_OK &&
                    size < row.bytes.size()) {
                    row.unpacked = row.bytes.size();
                    row.bytes = std::span(out).first(size);
                }
            }
            frames[pending->source] += static_cast<std::uint64_t>(row.frames);
            written += row.bytes.size();
        }
        const std::lock_guard file(file_mutex_);
        done = writer_.write(rows, events, counters);
    }
    const std::lock_guard lock(mutex_);
    if (!done && !failure_) failure_ = done.error();
    const bool stored = done && !failed;
    if (stored) bytes_written_ += written;
    for (auto& pending : blocks) {
        bytes += pending->block.bytes();
        const auto it = sources_.find(pending->source);
        if (it != sources_.end()) {
            if (stored)
                it->second->committed += static_cast<std::uint64_t>(pending->block.frames());
            else
                it->second->uncommitted += static_cast<std::uint64_t>(pending->block.frames());
        }
        pending->block.clear();
        pending->spots.clear();
        if (free_.size() < kFreeBlocks) free_.push_back(std::move(pending));
    }
    // A block counts its header too, which frame() leaves out.
    const std::size_t headers = blocks.size() * FrameBlock().bytes();
    waiting_bytes_ -= bytes - std::min(bytes, headers);
}

RecorderStatus Recorder::status() const {
    RecorderStatus status;
    std::vector<Source*> all;
    {
        const std::lock_guard lock(mutex_);
        status.bytes = bytes_written_;
        status.failure = failure_;
        for (const auto& [id, source] : sources_) {
            all.push_back(source.get());
            CaptureCounters& c = status.sources[source->name];
            c.frames = source->committed;
            c.dropped = source->uncommitted;
        }
    }
    for (Source* source : all) {
        const std::lock_guard lock(source->mutex);
        CaptureCounters& c = status.sources[source->name];
        c.damaged = source->damaged;
        c.lost = source->lost;
        c.dropped += source->dropped;
    }
    return status;
}

Expected<RecorderStatus> Recorder::finish(const std::string& how) {
    {
        const std::lock_guard lock(mutex_);
        finishing_ = true;
        wake_.notify_one();
    }
    if (thread_.joinable()) thread_.join();
    RecorderStatus status = this->status();
    const std::lock_guard file(file_mutex_);
    if (!finished_ && !status.failure) {
        finished_ = true;
        // The counters as they are at the end, dropped ones after the last block included.
        std::map<std::int64_t, CaptureCounters> counters;
        {
            const std::lock_guard lock(mutex_);
            for (const auto& [id, source] : sources_) counters[id] = status.sources[source->name];
        }
        auto done = writer_.write({}, {}, counters);
        if (done) done = writer_.finish(how);
        if (!done) {
            const std::lock_guard lock(mutex_);
            failure_ = status.failure = done.error();
        }
    }
    if (status.failure) return tl::unexpected(*status.failure);
    return status;
}

}  // namespace seamwright
