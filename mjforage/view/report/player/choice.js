// Which replay a panel shows: the world, then the policy and the episode in it.
const LEVELS = ["world", "policy", "episode"];

const agree = (a, b, levels) => levels.every((level) => a[level] === b[level]);

// Values to choose from at a level, for what is chosen above it, in the order of the replays.
function valuesAt(replays, chosen, level) {
  const above = LEVELS.slice(0, LEVELS.indexOf(level));
  const found = replays.filter((entry) => agree(entry, chosen, above));
  return [...new Set(found.map((entry) => entry[level]))];
}

// The replay with another value at a level: below it as like the one before as there is, an episode
// by its number, else by what it is among its own, such as the worst.
function chooseAt(replays, before, level, value) {
  const at = LEVELS.indexOf(level), wanted = { ...before, [level]: value };
  const likeness = (entry) => [
    ...LEVELS.slice(at + 1, -1).map((below) => entry[below] === before[below]),
    entry.episode === before.episode,
    entry.ranks.some((rank) => before.ranks.includes(rank)),
  ];
  const better = (a, b) => {
    const first = likeness(a), second = likeness(b);
    const differing = first.findIndex((like, i) => like !== second[i]);
    return differing >= 0 && first[differing];
  };
  return replays.filter((entry) => agree(entry, wanted, LEVELS.slice(0, at + 1)))
    .reduce((best, entry) => (better(entry, best) ? entry : best));
}

// What to set beside a replay at first: the last world, else the next policy, episode.
function besides(replays, entry) {
  const level = LEVELS.find((one) => valuesAt(replays, entry, one).length > 1);
  if (!level) return entry;
  const values = valuesAt(replays, entry, level);
  return chooseAt(replays, entry, level, values[level === "world" ? values.length - 1 : 1]);
}

function episodeWords({ episode, ranks }) {
  return `episode ${episode}${ranks.length ? ` (${ranks.join(", ")})` : ""}`;
}

// A choice's value in words.
function wordsOf(replays, chosen, level, value) {
  if (level === "world") return `${value} world`;
  if (level !== "episode") return value;
  return episodeWords(chooseAt(replays, chosen, level, value));
}
