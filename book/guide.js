'use strict';
/* Marks the tables that are wider than the page, for guide.css, and lets the keyboard reach them. */
for (const box of document.querySelectorAll('.table-wrapper')) {
  const look = () => {
    const beyond = box.scrollWidth - box.clientWidth;
    box.classList.toggle('is-wide', beyond > 4);
    box.classList.toggle('goes-on', beyond - box.scrollLeft > 4);
    if (beyond > 4) box.tabIndex = 0;
    else box.removeAttribute('tabindex');
  };
  box.addEventListener('scroll', look, { passive: true });
  new ResizeObserver(look).observe(box);
}
