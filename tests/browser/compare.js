// Body of a function of two pictures, as addresses of data: what differs between them. A square is as different as the mean over its
// pixels of the largest difference of a channel.
const SIDE = 16;
const load = async (url) => {
  const picture = new Image();
  picture.src = url;
  await picture.decode();
  const canvas = new OffscreenCanvas(picture.naturalWidth, picture.naturalHeight);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(picture, 0, 0);
  return context.getImageData(0, 0, canvas.width, canvas.height);
};
const [seen, expected] = [await load(seenUrl), await load(expectedUrl)];
const result = { seen: [seen.width, seen.height], expected: [expected.width, expected.height], worst: 0, at: [0, 0], squares: [] };
if (String(result.seen) !== String(result.expected)) return result;
for (let top = 0; top < seen.height; top += SIDE) {
  for (let left = 0; left < seen.width; left += SIDE) {
    let sum = 0, count = 0;
    for (let y = top; y < Math.min(top + SIDE, seen.height); y++) {
      for (let x = left; x < Math.min(left + SIDE, seen.width); x++) {
        const at = 4 * (y * seen.width + x);
        sum += Math.max(...[0, 1, 2].map((k) => Math.abs(seen.data[at + k] - expected.data[at + k])));
        count++;
      }
    }
    if (sum / count > result.worst) { result.worst = sum / count; result.at = [left, top]; }
    if (sum / count > tolerance) result.squares.push([left, top]);
  }
}
return result;
