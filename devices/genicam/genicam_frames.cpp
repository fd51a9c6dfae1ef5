// Buffers made frames.

#include <algorithm>

#include "devices/genicam/genicam_source.h"

namespace seamwright {

// A frame without its number is one of those that the next number shows to be missing.
void GenicamSource::count_gap(const Arrival& arrival) {
    if (!arrival.numbered) {
        ++unnumbered_;
        return;
    }
    if (last_sequence_ && arrival.sequence > *last_sequence_ + 1) {
        const std::uint64_t gap = arrival.sequence - *last_sequence_ - 1, known = std::min(gap, unnumbered_);
        counters_.lost += gap - known;
        unnumbered_ -= known;
    } else if (last_sequence_ && arrival.sequence < *last_sequence_ && counters_.lost > 0) {
        --counters_.lost;  // it comes after all
    }
    if (!last_sequence_ || arrival.sequence > *last_sequence_) last_sequence_ = arrival.sequence;
}

void GenicamSource::fill_payload(ArvBuffer* buffer, Frame& frame) {
    gint px = 0, py = 0;
    size_t size = 0;
    const void* data = arv_buffer_get_image_data(buffer, &size);
    const PixelFormat* format = pixel_format_by_code(arv_buffer_get_image_pixel_format(buffer));
    arv_buffer_get_image_padding(buffer, &px, &py);
    if (!data || !format || px < 0) {
        frame.status = FrameStatus::corrupt;
        return;
    }
    auto image = unpack_image(*format, {static_cast<const std::byte*>(data), size},
                              arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer),
                              static_cast<std::size_t>(px), frame.pixels, settings_.channel);
    if (image)
        frame.image = *image;
    else
        frame.status = FrameStatus::corrupt;
}

// Whether the image shows what the camera was started with: of ranges the columns, which its lines may end early.
bool GenicamSource::as_armed(ArvBuffer* buffer) const {
    ImageField f;
    arv_buffer_get_image_region(buffer, &f.x, &f.y, &f.width, &f.height);
    return range_ ? f.x == armed_.x && f.width == armed_.width : f == armed_;
}

// In the place of one that nothing came of, and that no later number shows.
FramePtr GenicamSource::lost_frame(std::uint64_t sequence) {
    auto frame = std::make_shared<Frame>();
    frame->status = FrameStatus::incomplete;
    frame->sequence = sequence;
    ++counters_.lost;
    last_sequence_ = sequence;
    return frame;
}

// Takes the buffer. nullptr: nothing to deliver, or its rows follow.
FramePtr GenicamSource::convert(ArvBuffer* buffer, const Arrival& arrival) {
    const ArvBufferStatus status = arv_buffer_get_status(buffer);
    if (status == ARV_BUFFER_STATUS_ABORTED || status == ARV_BUFFER_STATUS_CLEARED) {
        give_back(buffer);
        return nullptr;
    }
    count_gap(arrival);
    const bool whole = status == ARV_BUFFER_STATUS_SUCCESS && arrival.buffer == buffer && as_armed(buffer);
    if (range_ && whole && arrival.answer.verdict != TriggerPairing::Verdict::late) {
        rows_ = buffer;
        rows_arrival_ = arrival;
        next_row_ = 0;
        return nullptr;
    }
    FramePtr frame = pool_->acquire();
    if (!frame) {
        ++counters_.underrun;
        give_back(buffer);
        return nullptr;
    }
    frame->sequence = arrival.sequence;
    frame->host_time_ns = arrival.host_ns;
    if (arrival.answer.verdict == TriggerPairing::Verdict::late) {
        frame->status = FrameStatus::late;
        ++counters_.late;
    } else {
        frame->spot_id = arrival.answer.spot_id;
        if (whole) {
            frame->device_time_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
            if (chunks_ && arv_buffer_has_chunks(buffer)) {
                GFailure g;
                const gint64 ticks =
                    arv_chunk_parser_get_integer_value(chunks_.get(), buffer, "ChunkTimestamp", g.out());
                if (!g) frame->device_time_ns = ticks;
            }
            fill_payload(buffer, *frame);
        } else {
            const bool packets =
                status == ARV_BUFFER_STATUS_MISSING_PACKETS || status == ARV_BUFFER_STATUS_TIMEOUT;
            frame->status = packets ? FrameStatus::incomplete : FrameStatus::corrupt;
        }
        ++(frame->status == FrameStatus::ok ? counters_.completed : counters_.damaged);
    }
    give_back(buffer);
    publish(frame);
    return frame;
}

FramePtr GenicamSource::next_row() {
    const gint width = arv_buffer_get_image_width(rows_), height = arv_buffer_get_image_height(rows_);
    const PixelFormat* format = pixel_format_by_code(arv_buffer_get_image_pixel_format(rows_));
    const int row = next_row_++;
    FramePtr frame = height > 0 && row < height ? pool_->acquire() : nullptr;
    if (frame) {
        gint px = 0, py = 0;
        size_t size = 0;
        const void* data = arv_buffer_get_image_data(rows_, &size);
        arv_buffer_get_image_padding(rows_, &px, &py);
        const auto done =
            format && data
                ? range_row(*format, {static_cast<const std::byte*>(data), size}, width, height, row,
                            static_cast<std::size_t>(std::max(px, 0)), mapping_, frame->profile)
                : Expected<void>(device_error("no image", ""));
        if (!done) {
            frame->status = FrameStatus::corrupt;
            frame->profile.clear();
        }
        frame->sequence =
            rows_arrival_.sequence * static_cast<std::uint64_t>(height) + static_cast<std::uint64_t>(row);
        frame->host_time_ns = rows_arrival_.host_ns;
        frame->device_time_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(rows_));
        frame->spot_id = rows_arrival_.answer.spot_id;
        ++(done ? counters_.completed : counters_.damaged);
        publish(frame);
    } else if (row < height) {
        ++counters_.underrun;
    }
    if (row + 1 >= height) {
        give_back(rows_);
        rows_ = nullptr;
    }
    return frame;
}

}  // namespace seamwright
