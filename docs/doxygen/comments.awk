# SPDX-License-Identifier: Apache-2.0
# Makes of a header's plain comments what Doxygen takes for documentation: "//" above a declaration becomes "///", "//" behind
# a member "///<". Characters that mean something to Doxygen are escaped. What stands above the include guard is the file's.
function escaped(text) {
  gsub(/[\\@<>#%$&]/, "\\\\&", text)
  gsub(/~/, "\\~", text)
  return text
}
/^#define .*_H_$/ { inside = 1 }
/^\/\// && !inside {
  sub(/^\/\/ ?/, "")
  if ($0 ~ /SPDX-License-Identifier/) print ""
  else if (!file_comment) { file_comment = 1; print "/// \\file\n/// " escaped($0) }
  else print "/// " escaped($0)
  next
}
/^ *\/\/ ?/ {
  match($0, /^ *\/\//)
  indent = substr($0, 1, RLENGTH - 2)
  text = substr($0, RLENGTH + 1)
  sub(/^ /, "", text)
  print indent (behind && length(indent) > 8 ? "///< " : "/// ") escaped(text)
  next
}
{ behind = 0 }
/[;,{] +\/\/ / {
  position = match($0, /[;,{] +\/\/ /)
  behind = 1  # the next line may go on
  print substr($0, 1, position) "  ///< " escaped(substr($0, position + RLENGTH))
  next
}
{ print }
