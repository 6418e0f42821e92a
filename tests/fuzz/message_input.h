// SPDX-License-Identifier: Apache-2.0
// Protobuf messages out of a fuzzer's bytes, and a mutator that knows what they are: half of the
// mutations set one number of one message to a value at some edge, which flipping bits of a varint
// hardly ever reaches.
#ifndef OVERTONE_TESTS_FUZZ_MESSAGE_INPUT_H_
#define OVERTONE_TESTS_FUZZ_MESSAGE_INPUT_H_

#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "google/protobuf/message.h"
#include "google/protobuf/stubs/logging.h"
#include "overtone/tests/fuzz/fuzz_input.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t max_size);

namespace overtone::fuzz {

// Without a line on stderr for every string that is not UTF-8.
inline bool Parse(absl::string_view bytes, google::protobuf::MessageLite* message) {
  static const auto silent = google::protobuf::SetLogHandler(nullptr);
  (void)silent;
  return message->ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

// After its length, as Messages() takes it apart.
inline std::string Framed(const google::protobuf::MessageLite& message) {
  const std::string bytes = message.SerializeAsString();
  return std::string{static_cast<char>(bytes.size()), static_cast<char>(bytes.size() >> 8)} + bytes;
}

// Numbers of a message and of those in it.
class NumberSlots {
 public:
  using Message = google::protobuf::Message;
  using Field = google::protobuf::FieldDescriptor;

  explicit NumberSlots(Message* message) { Collect(message); }

  bool empty() const { return slots_.empty(); }

  void SetOne(std::mt19937& random) {
    const Slot& slot = slots_[random() % slots_.size()];
    const auto* reflection = slot.message->GetReflection();
    switch (slot.field->cpp_type()) {
      case Field::CPPTYPE_INT64:
        return Set(slot, Edge<int64_t>(random), &google::protobuf::Reflection::SetInt64,
                   &google::protobuf::Reflection::SetRepeatedInt64);
      case Field::CPPTYPE_UINT64:
        return Set(slot, Edge<uint64_t>(random), &google::protobuf::Reflection::SetUInt64,
                   &google::protobuf::Reflection::SetRepeatedUInt64);
      case Field::CPPTYPE_INT32:
        return Set(slot, Edge<int32_t>(random), &google::protobuf::Reflection::SetInt32,
                   &google::protobuf::Reflection::SetRepeatedInt32);
      case Field::CPPTYPE_UINT32:
        return Set(slot, Edge<uint32_t>(random), &google::protobuf::Reflection::SetUInt32,
                   &google::protobuf::Reflection::SetRepeatedUInt32);
      case Field::CPPTYPE_DOUBLE:
        return Set(slot, EdgeOfReals(random), &google::protobuf::Reflection::SetDouble,
                   &google::protobuf::Reflection::SetRepeatedDouble);
      case Field::CPPTYPE_FLOAT:
        return Set(slot, static_cast<float>(EdgeOfReals(random)),
                   &google::protobuf::Reflection::SetFloat,
                   &google::protobuf::Reflection::SetRepeatedFloat);
      case Field::CPPTYPE_BOOL:
        return Set(slot, random() % 2 == 0, &google::protobuf::Reflection::SetBool,
                   &google::protobuf::Reflection::SetRepeatedBool);
      default:
        if (!slot.field->is_repeated()) {
          reflection->SetEnumValue(slot.message, slot.field, static_cast<int>(random() % 16));
        }
    }
  }

 private:
  struct Slot {
    Message* message;
    const Field* field;
    int index;  // of a repeated field
  };

  void Collect(Message* message) {
    const auto* reflection = message->GetReflection();
    for (int i = 0; i < message->GetDescriptor()->field_count(); ++i) {
      const Field* field = message->GetDescriptor()->field(i);
      const bool is_message = field->cpp_type() == Field::CPPTYPE_MESSAGE;
      const int count = field->is_repeated() ? reflection->FieldSize(*message, field) : 1;
      if (field->cpp_type() == Field::CPPTYPE_STRING) continue;
      if (is_message && !field->is_repeated() && !reflection->HasField(*message, field)) continue;
      if (field->real_containing_oneof() != nullptr && !reflection->HasField(*message, field)) {
        continue;
      }
      for (int k = 0; k < count; ++k) {
        if (!is_message) {
          slots_.push_back({message, field, k});
        } else if (field->is_repeated()) {
          Collect(reflection->MutableRepeatedMessage(message, field, k));
        } else {
          Collect(reflection->MutableMessage(message, field));
        }
      }
    }
  }

  template <typename T, typename SetSingle, typename SetRepeated>
  void Set(const Slot& slot, T value, SetSingle single, SetRepeated repeated) {
    const auto* reflection = slot.message->GetReflection();
    if (slot.field->is_repeated()) {
      (reflection->*repeated)(slot.message, slot.field, slot.index, value);
    } else {
      (reflection->*single)(slot.message, slot.field, value);
    }
  }

  // Near zero, near a power of two, or at an end of the type.
  template <typename T>
  static T Edge(std::mt19937& random) {
    const T small = static_cast<T>(static_cast<int64_t>(random() % 7) - 3);
    switch (random() % 4) {
      case 0:
        return small;
      case 1:
        return std::numeric_limits<T>::max() - static_cast<T>(random() % 3);
      case 2:
        return std::numeric_limits<T>::min() + static_cast<T>(random() % 3);
      default:
        return (T{1} << random() % (std::numeric_limits<T>::digits)) - 1 +
               static_cast<T>(random() % 3);
    }
  }

  static double EdgeOfReals(std::mt19937& random) {
    constexpr double kEdges[] = {0,     -0.0, 1,     -1,    0.5,    1e-18,  1e-19, 1e12,
                                 1.001, 1e7,  1.1e7, 1e300, -1e300, 1e-310, 0.1,   1e-300};
    const size_t edge = random() % (std::size(kEdges) + 3);
    if (edge < std::size(kEdges)) return kEdges[edge];
    if (edge == std::size(kEdges)) return std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    return edge == std::size(kEdges) + 1 ? infinity : -infinity;
  }

  std::vector<Slot> slots_;
};

// A mutator for streams of `Frame`s.
template <typename Frame>
size_t MutateFrames(uint8_t* data, size_t size, size_t max_size, unsigned seed) {
  std::mt19937 random(seed);
  const std::vector<absl::string_view> messages = Messages(AsText(data, size));
  if (random() % 2 == 0 || messages.empty()) return LLVMFuzzerMutate(data, size, max_size);
  const size_t chosen = random() % messages.size();
  std::string mutated;
  for (size_t i = 0; i < messages.size(); ++i) {
    Frame frame;
    const bool parsed = Parse(messages[i], &frame);
    NumberSlots slots(&frame);
    if (i == chosen && (!parsed || slots.empty())) return LLVMFuzzerMutate(data, size, max_size);
    if (i == chosen) slots.SetOne(random);
    mutated += Framed(frame);
  }
  if (mutated.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, mutated.data(), mutated.size());
  return mutated.size();
}

}  // namespace overtone::fuzz

#endif  // OVERTONE_TESTS_FUZZ_MESSAGE_INPUT_H_
