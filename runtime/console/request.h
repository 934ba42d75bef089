#pragma once

#include <cstdint>
#include <string_view>

#include "runtime/base/fixed_text.h"
#include "runtime/base/fixed_vector.h"
#include "runtime/base/status.h"
#include "runtime/console/verbs.h"

namespace roomcal::console {

using Word = FixedText<63>;

/// One line, taken apart; not yet checked against the verbs.
struct Request {
  Word verb;
  FixedVector<Word, kMaxArguments> arguments;
  bool json = false;
  bool has_id = false;
  int64_t id = 0;  ///< of a JSON request: comes back in its answer
};

/// Words between spaces.
/// @return kOutOfRange for more arguments or longer words than any verb takes; an empty line gives an empty verb.
Status parse_words(std::string_view line, Request& request);

/// `{"cmd": "export", "args": ["kalibr"], "id": 7}`: strict JSON of this shape only, keys once and in any order, args
/// and id optional. Strings are printable ASCII with the escapes \" \\ \/.
/// @param[out] request  id is set as soon as it was read, so that even a refusal can carry it.
/// @return kInvalidArgument with what is wrong; kOutOfRange as parse_words().
Status parse_json(std::string_view line, Request& request);

}  // namespace roomcal::console
